#!/usr/bin/env python3
"""Reads all includes of the tree and refuses what breaks the layout that docs/architecture.md describes.

    check_includes.py SOURCE_DIR     checks the tree, then checks itself on made-up trees

A room is a header together with its source (folder/name.h or folder/internal/name.h, and folder/name.cpp). Refused are
  - an include that points upward in ORDER;
  - a circle of rooms;
  - an outside library in a folder that is not its place (PLACES);
  - a header of an `internal` folder included from elsewhere, or by a header that is installed;
  - an include of a header that does not exist;
  - a folder table in docs/architecture.md that does not list the folders of the tree in this order.
"""
import pathlib
import re
import sys
import tempfile

# The folders from the bottom up: each may include itself and what stands before it. Some are planned.
ORDER = ['base', 'image', 'mask', 'mesh', 'surface', 'raster', 'synthetic', 'energies', 'seed', 'solve', 'fit', 'settings', 'job',
         'picture', 'output', 'batch', 'cli']
# Folders that may use fewer than what stands before them: the phantoms are an oracle without any code of the models, and the
# solvers know no image and no seed.
ONLY = {'synthetic': {'base', 'image', 'mesh', 'synthetic'}, 'solve': {'base', 'mesh', 'surface', 'energies', 'solve'}}
OUTSIDE_SRC = {'data-synthetic': 'synthetic', 'energies': 'energies', 'cli': 'cli'}

# Outside libraries and the only folders that may include them.
PLACES = [
    (re.compile(r'itk[A-Z]\w*\.h|gdcm\w*\.h|tiff\w*\.h|nifti\w*\.h'), {'image'}),
    (re.compile(r'opensubdiv/.*'), {'surface'}),
    (re.compile(r'openvdb/.*'), {'raster'}),
    (re.compile(r'embree\d*/.*|nanoflann\.hpp'), {'mesh'}),
    (re.compile(r'CLI/.*'), {'cli'}),
    (re.compile(r'ceres/(?!version\.h).*|Eigen/CholmodSupport|cholmod\.h'), {'solve'}),
]
# Calls with a place of their own.
CALLS = [(re.compile(r'\bceres::(GradientProblemSolver::)?Solve\b'), {'solve'})]

# Circles that are still there, to be removed: one may become smaller, never larger, and no other may appear.
KNOWN_CIRCLES = []

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def room_of(name):
    return name.rsplit('.', 1)[0].replace('/internal/', '/')


class File:
    """A source or header; `name` is how an include spells it, without "pellicle/"."""

    def __init__(self, path, name):
        self.path, self.name = path, name
        self.folder = name.split('/')[0]
        self.room = room_of(name)
        text = path.read_text()
        self.own, self.outside = [], []
        for kind, target in INCLUDE.findall(text):
            if target.startswith('pellicle/'):
                self.own.append(target[len('pellicle/'):])
            elif kind == '<' or '/' in target:
                self.outside.append(target)
        self.code = re.sub(r'//.*', '', text)


def files_under(top, name):
    for path in sorted(top.rglob('*')):
        if path.suffix in ('.h', '.cpp'):
            yield File(path, f'{name}/{path.relative_to(top)}')


def library_files(root):
    tops = {path.name: path for path in sorted((root / 'src').iterdir()) if path.is_dir()} if (root / 'src').is_dir() else {}
    tops.update({name: root / top for top, name in OUTSIDE_SRC.items() if (root / top).is_dir()})
    return [file for name, top in tops.items() for file in files_under(top, name)]


def test_files(root):
    return list(files_under(root / 'tests', 'tests')) + list(files_under(root / 'bench', 'bench'))


def upward(files):
    for file in files:
        if file.folder not in ORDER:
            yield f'{file.path}: folder "{file.folder}" is not in ORDER'
            continue
        allowed = ONLY.get(file.folder, set(ORDER[:ORDER.index(file.folder) + 1]))
        for target in file.own:
            if target.split('/')[0] not in allowed:
                yield f'{file.path}: includes {target}; {file.folder} may not use {target.split("/")[0]}'


def missing(files, spelled):
    names = {file.name for file in spelled}
    for file in files:
        for target in file.own:
            if target not in names:
                yield f'{file.path}: includes {target}, which does not exist'


def circles(files):
    """Strongly connected sets of more than one room (Tarjan), as sorted lists."""
    uses = {}
    for file in files:
        uses.setdefault(file.room, set()).update(room_of(target) for target in file.own if room_of(target) != file.room)
    number, low, stack, found = {}, {}, [], []

    def visit(room):
        number[room] = low[room] = len(number)
        stack.append(room)
        for used in sorted(uses.get(room, ())):
            if used not in number:
                visit(used)
                low[room] = min(low[room], low[used])
            elif used in stack:
                low[room] = min(low[room], number[used])
        if low[room] == number[room]:
            circle = stack[stack.index(room):]
            del stack[-len(circle):]
            if len(circle) > 1:
                found.append(sorted(circle))

    sys.setrecursionlimit(10000)
    for room in sorted(uses):
        if room not in number:
            visit(room)
    return found


def unknown_circles(files, known):
    for circle in circles(files):
        if not any(set(circle) <= k for k in known):
            yield 'circle of rooms: ' + ', '.join(circle)


def places(files):
    for file in files:
        for target in file.outside:
            for pattern, folders in PLACES:
                if pattern.fullmatch(target) and file.folder not in folders:
                    yield f'{file.path}: includes <{target}>, whose place is {" and ".join(sorted(folders))}'
        for pattern, folders in CALLS:
            if pattern.search(file.code) and file.folder not in folders:
                yield f'{file.path}: calls {pattern.search(file.code).group(0)}, whose place is {" and ".join(sorted(folders))}'


def private(files, tests):
    """An internal header belongs to the folder that holds `internal`, and to the tests of that folder."""
    for file in files + tests:
        for target in file.own:
            if '/internal/' not in target:
                continue
            owner = target.split('/internal/')[0]
            mirror = owner.split('/')[0]
            inside = file.name.startswith(owner + '/') or file.name.startswith(f'tests/{mirror}/') or file.name.startswith('bench/')
            if not inside:
                yield f'{file.path}: includes {target}, which is for the sources of {owner} only'
            elif file in files and file.name.endswith('.h') and '/internal/' not in file.name:
                yield f'{file.path}: is installed but includes {target}, which is not'


def table(root, files):
    page = (root / 'docs' / 'architecture.md').read_text()
    rows = re.findall(r'^\| *`(?:src/)?([\w-]+)` *\|', page, re.MULTILINE)
    rows = [OUTSIDE_SRC.get(row, row) for row in rows]
    wanted = [folder for folder in ORDER if folder in {file.folder for file in files}]
    if rows != wanted:
        yield f'docs/architecture.md: the table lists {" ".join(rows)}; the tree has {" ".join(wanted)}'


def complaints(root, known=()):
    files, tests = library_files(root), test_files(root)
    faults = [*upward(files), *missing(files + tests, files), *unknown_circles(files, known), *places(files), *private(files, tests)]
    if (root / 'docs' / 'architecture.md').is_file():
        faults += table(root, files)
    return faults


def check_itself():
    """Each made-up tree has one fault, which must be found, and nothing else may be."""
    good = {
        'src/base/a.h': '', 'src/base/a.cpp': '#include "pellicle/base/a.h"\n#include <vector>',
        'src/raster/b.cpp': '#include <openvdb/openvdb.h>\n#include "pellicle/raster/internal/c.h"\n#include "pellicle/base/a.h"',
        'src/raster/internal/c.h': '', 'tests/raster/t.cpp': '#include "pellicle/raster/internal/c.h"',
        'data-synthetic/d.h': '#include "pellicle/base/a.h"', 'cli/main.cpp': '#include <CLI/CLI.hpp>\n// ceres::Solve elsewhere',
        'src/solve/c.cpp': '#include <ceres/ceres.h>\nvoid f() { ceres::Solve(); }', 'src/fit/s.cpp': '',
        'docs/architecture.md': '| `src/base` | |\n| `src/raster` | |\n| `data-synthetic` | |\n| `src/solve` | |\n| `src/fit` | |\n| `cli` | |\n',
    }
    bad = {
        'an upward include': ({'src/base/a.h': '#include "pellicle/fit/s.h"', 'src/fit/s.h': ''}, 'may not use fit'),
        'the oracle using the models': ({'data-synthetic/e.cpp': '#include "pellicle/raster/r.h"', 'src/raster/r.h': ''}, 'may not use raster'),
        'an unknown folder': ({'src/attic/x.h': '', 'docs/architecture.md': good['docs/architecture.md']}, 'not in ORDER'),
        'a circle through a source': ({'src/base/a.cpp': '#include "pellicle/base/e.h"', 'src/base/e.h': '#include "pellicle/base/a.h"'},
                                      'circle of rooms: base/a, base/e'),
        'a missing header': ({'src/fit/s.cpp': '#include "pellicle/base/gone.h"'}, 'does not exist'),
        'a library out of place': ({'src/fit/s.cpp': '#include <openvdb/openvdb.h>'}, 'whose place is raster'),
        'CLI11 below cli': ({'src/fit/s.cpp': '#include <CLI/CLI.hpp>'}, 'whose place is cli'),
        'a solver above the solver': ({'cli/main.cpp': 'int main() { ceres::Solve(); }'}, 'calls ceres::Solve'),
        'a private header used elsewhere': ({'src/fit/s.cpp': '#include "pellicle/raster/internal/c.h"'}, 'for the sources of raster only'),
        'a private header in a public one': ({'src/raster/p.h': '#include "pellicle/raster/internal/c.h"'}, 'is installed but'),
        'a table that lags behind': ({'src/seed/n.h': ''}, 'the table lists'),
    }
    for case, (change, wanted) in {'nothing wrong': ({}, None), **bad}.items():
        with tempfile.TemporaryDirectory() as folder:
            for name, text in {**good, **change}.items():
                path = pathlib.Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            found = complaints(pathlib.Path(folder))
            if wanted is None and found or wanted is not None and not (len(found) == 1 and wanted in found[0]):
                return [f'self-check, {case}: expected {wanted!r}, found {found}']
            if case.startswith('a circle') and any(unknown_circles(library_files(pathlib.Path(folder)), [{'base/a', 'base/e', 'base/z'}])):
                return ['self-check: a known circle is not tolerated']
    return []


def main():
    root = pathlib.Path(sys.argv[1])
    faults = complaints(root, KNOWN_CIRCLES) + check_itself()
    print('\n'.join(faults) if faults else 'all includes point downward')
    left = [set(circle) for circle in circles(library_files(root))]
    for known in KNOWN_CIRCLES:
        if not any(circle <= known for circle in left):
            print('gone, take it off KNOWN_CIRCLES: ' + ', '.join(sorted(known)))
    return 1 if faults else 0


sys.exit(main())
