"""One run of one program: exit code, stdout, stderr, seconds."""
import os
import pathlib
import subprocess
import tempfile
import time
from typing import NamedTuple

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Run(NamedTuple):
    exit_code: int
    stdout: bytes
    stderr: bytes
    seconds: float
    processor_seconds: float  # of all threads and child processes


def environment():
    """Both programs read the same presets, those of this tree unless PELLICLE_PRESETS names others."""
    return {"PELLICLE_PRESETS": str(ROOT / "presets"), **os.environ, "LC_ALL": "C"}


def run(program, words, folder):
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        start = time.monotonic()
        child = subprocess.Popen([str(program), *words], cwd=folder, env=environment(), stdin=subprocess.DEVNULL, stdout=out, stderr=err)
        _, status, usage = os.wait4(child.pid, 0)
        seconds = time.monotonic() - start
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        return Run(child.returncode, out.read(), err.read(), seconds, usage.ru_utime + usage.ru_stime)


def run_well(program, words, folder):
    """A run that has to succeed."""
    done = run(program, words, folder)
    if done.exit_code != 0:
        raise SystemExit(f"{program} {' '.join(words)}: exit code {done.exit_code}: {done.stderr.decode('utf-8', 'replace')}")
    return done
