"""The energies that docs/energies.md describes are those of the program, each with a section.

Usage: check_energies.py PELLICLE ENERGIES_MD
"""
import pathlib
import re
import subprocess
import sys


def main(program, page):
    listed = subprocess.run([program, "segment", "--energy", "list"], capture_output=True, text=True, check=True).stdout
    known = [line.split()[:2] for line in listed.splitlines() if line and not line.startswith(" ")]
    text = pathlib.Path(page).read_text()
    table = [(name, kind) for name, kind in re.findall(r"^\| `(\w+)` \| (residual|scalar)\b", text, re.M)]
    problems = []
    if sorted(tuple(k) for k in known) != sorted(table):
        problems.append(f"the table says {table}, the program {known}")
    problems += [f"no section of {name}" for name, _ in known if f"\n### {name}\n" not in text]
    print("\n".join(problems) or f"{len(known)} energies are described")
    return 1 if problems or not known else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
