"""Files that a page shows stand there word for word.

Usage: check_shown.py DOCS_FOLDER
    <!-- file extending/floor.h -->      before a block: the path of the file, relative to the folder
Compiled they are elsewhere (tests/extending).
"""
import pathlib
import re
import sys

SHOWN = re.compile(r"<!-- file (\S+) -->\n```[a-z]*\n(.*?)```", re.S)


def main(folder):
    docs, problems, shown = pathlib.Path(folder), [], set()
    for page in sorted(docs.rglob("*.md")):
        for path, block in SHOWN.findall(page.read_text()):
            shown.add(path)
            if block != (docs / path).read_text():
                problems.append(f"{page.name} does not show {path} as it is: copy the file into the block")
    for path in sorted(p.relative_to(docs).as_posix() for p in (docs / "extending").iterdir()):
        if path not in shown:
            problems.append(f"no page shows {path}")
    print("\n".join(problems) or f"{len(shown)} files are shown as they are")
    return 1 if problems or not shown else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
