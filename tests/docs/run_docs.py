"""Runs the commands that the documentation shows.

Usage: run_docs.py PELLICLE DOCS_FOLDER
A block of commands is run when a comment stands before it:
    <!-- run
    commands that set up what the block uses
    -->
Each file has a folder of its own, where its blocks run one after the other. A command may end with 0 or 3 (done, look at
the result); anything else is a fault of the page.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"<!-- run\n(.*?)-->\n+```[a-z]*\n(.*?)```", re.S)


def logical_lines(text):
    """One command each: lines that end with a backslash go on."""
    return [line for line in text.replace("\\\n", " ").splitlines() if line.strip()]


def main(program, docs):
    problems, count = [], 0
    environment = dict(os.environ, PATH=f"{pathlib.Path(program).parent}:{os.environ['PATH']}")
    for page in sorted(pathlib.Path(docs).rglob("*.md")):
        blocks = BLOCK.findall(page.read_text())
        with tempfile.TemporaryDirectory() as folder:
            for commands in blocks:
                for line in logical_lines(commands[0]) + logical_lines(commands[1]):
                    count += 1
                    run = subprocess.run(["bash", "-c", line], cwd=folder, env=environment, capture_output=True, text=True)
                    if run.returncode not in (0, 3):
                        problems.append(f"{page.name}: {line}\n  {run.returncode}: {run.stderr.strip()}")
    if count < 15:
        problems.append(f"only {count} commands were found")
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
