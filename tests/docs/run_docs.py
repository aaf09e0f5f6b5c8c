"""Runs the commands that the documentation shows.

Usage: run_docs.py PELLICLE SOURCE_FOLDER
A block of commands is run when a comment stands before it:
    <!-- run
    commands that set up what the block uses
    -->
Each file has a folder of its own, where its blocks run one after the other. A command may end with 0 or 3 (done, look at
the result); anything else is a fault of the page. `make_volume` stands for make_volume.py of this folder.
A block that calls pellicle and is not run must say why, before it:
    <!-- not run: the reason -->
Two of the README's blocks do not call pellicle: scripts/demo.sh and scripts/test.sh install packages and build, and the second is what
runs this test.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

BLOCK = re.compile(r"(?:<!-- (run|not run: [^\n]+?)(?:\n| )(.*?)-->\n+)?```([a-z]*)\n(.*?)```", re.S)


def logical_lines(text):
    """One command each: lines that end with a backslash go on."""
    return [line for line in text.replace("\\\n", " ").splitlines() if line.strip()]


def main(program, source):
    problems, count = [], 0
    program = pathlib.Path(program).resolve()
    make_volume = f"make_volume() {{ {sys.executable} {pathlib.Path(__file__).parent}/make_volume.py \"$@\"; }}; "
    environment = dict(os.environ, PATH=f"{program.parent}:{os.environ['PATH']}")
    for page in [pathlib.Path(source) / "README.md", *sorted((pathlib.Path(source) / "docs").rglob("*.md"))]:
        with tempfile.TemporaryDirectory() as folder:
            for marked, setup, _, block in BLOCK.findall(page.read_text()):
                if marked != "run":
                    if not marked and re.search(r"^pellicle [a-z]", block, re.M):
                        problems.append(f"{page.name}: a block is not run and does not say why: {block.splitlines()[0]}")
                    continue
                for line in logical_lines(setup) + logical_lines(block):
                    count += 1
                    started = time.time()
                    run = subprocess.run(["bash", "-c", make_volume + line], cwd=folder, env=environment, capture_output=True, text=True)
                    print(f"{time.time() - started:6.1f} s  {page.name}: {line}")
                    if run.returncode not in (0, 3):
                        problems.append(f"{page.name}: {line}\n  {run.returncode}: {run.stderr.strip()}")
    if count < 30:
        problems.append(f"only {count} commands were found")
    print("\n".join(problems) or f"{count} commands ran")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
