"""Runs the same commands with two programs and compares every output, stdout, stderr and exit code.

One line a command: same, or DIFFERENT with the outputs that differ and the first place where they do. Exit code 1 when
anything differs. What may differ (times, memory, dates, versions, paths) is masked first: masks.py.
"""
import argparse
import concurrent.futures
import pathlib
import shutil
import sys
import tempfile

import commands
import masks
import programs

TIMED = ("segment", "batch", "bids", "fit")  # the lines on stdout end with seconds
PAIRS = 3  # pairs of lines that are shown


class Side:
    """One of the two programs, with its folder and number of threads."""

    def __init__(self, program, folder, threads, mask):
        self.program, self.folder, self.threads, self.mask = program, folder, threads, mask
        self.seen = {}
        self.seconds = self.last = 0.0

    def new_files(self):
        """Files that were written since the last call, by their place in the folder."""
        written = {}
        for path in sorted(self.folder.rglob("*")):
            if not path.is_file():
                continue
            state = path.stat()
            key = (state.st_mtime_ns, state.st_size)
            if self.seen.get(path) != key:
                self.seen[path] = key
                self.mask.learn(path)
                written[str(path.relative_to(self.folder))] = path
        return written

    def run(self, name, command):
        """All that the command leaves behind, masked: name of the output -> bytes."""
        words = commands.arguments(command, name, self.threads)
        if words[0] == "export":  # makes no folder
            (self.folder / "out" / name).mkdir(parents=True)
        done = programs.run(self.program, words, self.folder)
        self.last = done.processor_seconds
        self.seconds += self.last
        found = {place: self.mask.of_file(path) for place, path in self.new_files().items()}
        for stream, text in (("stdout", done.stdout), ("stderr", done.stderr)):
            timed = stream == "stdout" and words[0] in TIMED
            found[stream] = self.mask.of_stream(text.decode("utf-8", "replace"), timed).encode()
        found["exit code"] = str(done.exit_code).encode()
        return found


def excerpt(line, at):
    """The line near the place `at`, in printable characters."""
    start = max(0, at - 60)
    return ("..." if start else "") + line[start:at + 80] + ("..." if len(line) > at + 80 else "")


def first_differences(old, new):
    """Where two outputs part, in a few lines."""
    try:
        a, b = old.decode().split("\n"), new.decode().split("\n")
    except UnicodeDecodeError:
        if len(old) != len(new):
            return [f"{len(old)} bytes against {len(new)}"]
        unequal = [n for n, (x, y) in enumerate(zip(old, new)) if x != y]
        return [f"{len(unequal)} of {len(old)} bytes differ, from byte {unequal[0]} on"]
    unequal = [n for n, (x, y) in enumerate(zip(a, b)) if x != y]
    lines = []
    for n in unequal[:PAIRS if len(a) == len(b) else 1]:
        at = next((k for k, (p, q) in enumerate(zip(a[n], b[n])) if p != q), min(len(a[n]), len(b[n])))
        lines += [f"line {n + 1} old: {excerpt(a[n], at)}", f"line {n + 1} new: {excerpt(b[n], at)}"]
    if len(a) != len(b):
        return lines + [f"{len(a)} lines against {len(b)}"]
    return lines + ([f"{len(unequal)} lines differ"] if len(unequal) > PAIRS else [])


def faults_of(old, new):
    lines = []
    for output in sorted(set(old) | set(new)):
        if output not in new or output not in old:
            lines.append(f"  {output}: only of the {'old' if output in old else 'new'} program")
        elif old[output] != new[output]:
            lines.append(f"  {output}")
            lines += [f"    {line}" for line in first_differences(old[output], new[output])]
    return lines


def chosen(arguments):
    every = {**commands.SHORT, **commands.FULL}
    if arguments.self:
        every = {name: every[name] for name in commands.THREADS}
    elif arguments.short:
        every = commands.SHORT
    if arguments.only:
        every = {name: command for name, command in every.items() if any(part in name for part in arguments.only)}
    left_out = [name for name, command in every.items() if commands.CH2 in command and not pathlib.Path(commands.CH2).exists()]
    if left_out:
        print(f"left out, no {commands.CH2}: {' '.join(left_out)}")
    return {name: command for name, command in every.items() if name not in left_out}


def compare(arguments, scratch):
    threads = (1, 2) if arguments.self else tuple(int(n) for n in arguments.threads.split(","))
    old_program, new_program = (pathlib.Path(p).absolute() for p in
                                ((arguments.self, arguments.self) if arguments.self else arguments.programs))
    for side in ("old", "new"):
        (scratch / side).mkdir(parents=True)
    commands.make_inputs(str(old_program), scratch / "old")
    shutil.copytree(scratch / "old", scratch / "new", dirs_exist_ok=True)
    sides = [Side(program, scratch / name, count, masks.Mask((old_program, new_program), scratch / name, threads[0] != threads[-1]))
             for program, name, count in ((old_program, "old", threads[0]), (new_program, "new", threads[-1]))]
    for side in sides:
        side.new_files()
    asked, different = chosen(arguments), 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for name, command in asked.items():
            old, new = pool.map(lambda side: side.run(name, command), sides)
            lines = faults_of(old, new)
            different += bool(lines)
            print(f"{'DIFFERENT' if lines else 'same':10}{name}  (exit {old['exit code'].decode()}, {len(old)} outputs, "
                  f"{sides[0].last:.1f} s)", *lines, sep="\n", flush=True)
    print(f"{len(asked)} commands, {different} different; {sides[0].seconds:.0f} s and {sides[1].seconds:.0f} s of processor time")
    return 1 if different else 0


def main():
    parser = argparse.ArgumentParser(prog="same_bytes.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="*", metavar="PROGRAM", help="OLD and NEW, two pellicle programs")
    parser.add_argument("--short", action="store_true", help="fewer commands, about a minute")
    parser.add_argument("--self", metavar="PROGRAM", help="one program with one thread against itself with two, a few commands")
    parser.add_argument("--threads", default="1", metavar="N[,M]", help="threads of OLD and of NEW (default 1; 0: as the program likes)")
    parser.add_argument("--only", action="append", metavar="PART", help="commands whose name has PART in it; repeat for more")
    parser.add_argument("--keep", metavar="DIR", help="keep the folders of both programs in DIR, a new folder")
    arguments = parser.parse_args()
    if bool(arguments.self) == bool(arguments.programs) or len(arguments.programs) not in (0, 2):
        parser.error("OLD and NEW, or --self PROGRAM")
    if arguments.keep:
        if pathlib.Path(arguments.keep).exists():
            parser.error(f"{arguments.keep} is there already")
        return compare(arguments, pathlib.Path(arguments.keep).absolute())
    with tempfile.TemporaryDirectory() as scratch:
        return compare(arguments, pathlib.Path(scratch))


if __name__ == "__main__":
    sys.exit(main())
