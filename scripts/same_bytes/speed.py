"""Seconds of two programs for the same commands, run in turn so that both meet the same machine.

A table: the least and the median seconds of each, the ratio new/old of the least, and the same ratio of processor time (all
threads), which other work on the machine disturbs less. A command is slower when both ratios are above 1.05; exit code 1.
"""
import argparse
import pathlib
import shlex
import shutil
import statistics
import sys
import tempfile

import commands
from programs import run, run_well

LIMIT = 1.05

PHANTOMS = """
--name big --shape bean --radius 60 --size 256,256,256 --seed 7
--name small --shape bean --radius 20 --size 96,96,96 --seed 7
--name cells --shape cluster --count 200 --radius 5,8 --size 220,220,110 --seed 4
"""
CASES = {
    "normal, 256^3": "segment -i big.nii.gz -o out",
    "catmull-clark, 256^3": "segment -i big.nii.gz -o out --model catmull-clark",
    "brain-t1, ch2": f"segment -i {commands.CH2} -o out --preset brain-t1",
    "many, 200 nuclei": "segment -i cells.nii.gz -o out --objects many",
    "fit, 5000 points": "fit -i cloud.xyz -o out",
    "spline, 96^3": "segment -i small.nii.gz -o out --model spline",
}


def measure(program, command, folder):
    shutil.rmtree(folder / "out", ignore_errors=True)
    done = run(program, shlex.split(command), folder)
    if done.exit_code not in (0, 3):  # 3: files are written, an object failed its own checks
        raise SystemExit(f"{program} {command}: exit code {done.exit_code}: {done.stderr.decode('utf-8', 'replace')}")
    return done


def row_of(name, runs):
    least, median, work = ([f([getattr(done, key) for done in side]) for side in runs]
                           for f, key in ((min, "seconds"), (statistics.median, "seconds"), (min, "processor_seconds")))
    ratio, work_ratio = least[1] / least[0], work[1] / work[0]
    slower = ratio > LIMIT and work_ratio > LIMIT
    print(f"{name:22}{least[0]:9.2f}{median[0]:9.2f}{least[1]:9.2f}{median[1]:9.2f}{ratio:9.3f}{work_ratio:11.3f}"
          f"{'  SLOWER' if slower else ''}", flush=True)
    return slower


def main():
    parser = argparse.ArgumentParser(prog="old_and_new_speed.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=pathlib.Path)
    parser.add_argument("new", type=pathlib.Path)
    parser.add_argument("rounds", type=int, nargs="?", default=5, help="runs of each command by each program (default 5)")
    parser.add_argument("--only", metavar="PART", default="", help="commands whose name has PART in it")
    arguments = parser.parse_args()
    both = [arguments.old.absolute(), arguments.new.absolute()]
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for line in PHANTOMS.strip().splitlines():
            run_well(both[0], ["phantom", "-o", ".", *line.split()], folder)
        (folder / "cloud.xyz").write_text(commands.rows(commands.cloud(5000, False), " "))
        print(f"{'seconds':22}{'old min':>9}{'median':>9}{'new min':>9}{'median':>9}{'new/old':>9}{'processor':>11}")
        slower = []
        for name, command in CASES.items():
            if arguments.only not in name or (commands.CH2 in command and not pathlib.Path(commands.CH2).exists()):
                continue
            runs = [[], []]
            for turn in range(arguments.rounds):
                for side in ((0, 1) if turn % 2 == 0 else (1, 0)):  # who comes second meets warm files
                    runs[side].append(measure(both[side], command, folder))
            slower += [name] if row_of(name, runs) else []
    print(f"slower by more than {100 * (LIMIT - 1):.0f} %: {'; '.join(slower) or 'none'}")
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
