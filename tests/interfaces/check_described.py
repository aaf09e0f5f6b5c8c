"""Manual pages and completion say what --help says.

Usage: check_described.py PELLICLE
"""
import re
import shutil
import subprocess
import sys
import tempfile


def output(*words, **more):
    return subprocess.run(words, capture_output=True, text=True, check=True, **more).stdout


def complete(script, words):
    """What bash offers after these words."""
    line = f"""source "$1"; COMP_WORDS=({' '.join(f"'{w}'" for w in words)}); COMP_CWORD={len(words) - 1}
               _pellicle; printf '%s\\n' "${{COMPREPLY[@]}}" """
    return output("bash", "-c", line, "bash", script).split()


def main(program):
    problems = []
    helped = output(program, "--help")
    commands = re.findall(r"^  ([a-z]+) {2,}\S", helped.split("Subcommands:")[1], re.M)
    if len(commands) < 10:
        problems.append(f"commands: {commands}")
    with tempfile.NamedTemporaryFile("w", suffix=".bash") as script:
        script.write(output(program, "completion", "bash"))
        script.flush()
        if set(complete(script.name, ["pellicle", ""])) != set(commands) | {"--help", "--version"}:
            problems.append("completion: other commands than --help")
        for command in commands:
            flags = set(re.findall(r"(?<![\w-])--[a-z][a-z_-]*", re.sub(r"(?m)^( {20,}|[^ ]).*", "", output(program, command, "--help"))))
            offered = set(complete(script.name, ["pellicle", command, "--"]))
            if not {"--help"} <= offered or offered - flags:
                problems.append(f"{command}: offered but not in the help: {offered - flags}")
            page = output(program, "manual", command).replace("\\-", "-")
            missing = {flag for flag in offered if flag not in page}
            if missing:
                problems.append(f"manual of {command}: {missing} missing")
            if shutil.which("groff"):
                told = subprocess.run(["groff", "-man", "-Tascii", "-ww", "-z"], input=output(program, "manual", command),
                                      capture_output=True, text=True)
                if told.stderr:
                    problems.append(f"manual of {command}: {told.stderr}")
        if complete(script.name, ["pellicle", "segment", "--polarity", ""]) != ["bright", "dark", "auto"]:
            problems.append("completion: choices of --polarity")
        if complete(script.name, ["pellicle", "segment", "--seed-r"]) != ["--seed-radius"]:
            problems.append("completion: --seed-r")
    version = output(program, "--version")
    if not re.match(r"pellicle \d+\.\d+\.\d+\n", version) or not all(n in version for n in ("Ceres 2", "ITK 5", "OpenVDB 10")):
        problems.append(f"version: {version}")
    for words in (["manual", "melt"], ["completion", "fish"]):
        wrong = subprocess.run([program, *words], capture_output=True, text=True)
        if wrong.returncode != 64 or wrong.stderr.count("\n") != 1:
            problems.append(f"{words}: {wrong.returncode} {wrong.stderr}")
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
