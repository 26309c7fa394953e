"""Runs of the default tests one after the other, some of them next to busy processors, to see whether to trust them.

`python -m tests.many_runs --runs 20 --busy 10` prints a table in Markdown, and ends with 1 if any test failed. The last
runs are those next to busy loops. Words after `--` go to pytest: `-- tests/teacher/page`.
"""

import argparse
import re
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

LOOPS = 4
"""Busy loops next to a run: twice the processors of the machine on which the suite has to pass."""
WORKERS = ("-n", "3", "--dist", "loadfile", "--no-loadscope-reorder")
_COUNT = re.compile(r"(\d+) (passed|failed|errors?)\b")
_FAILED = re.compile(r"^(?:FAILED|ERROR) (\S+)", re.MULTILINE)
_BUSY = "while True: pass"
HEAD = "| run | busy loops | passed | failed | seconds | failed tests |\n|---|---|---|---|---|---|"


@dataclass(frozen=True)
class Run:
    """Counts of one run of the tests, and its failed tests by name."""

    passed: int
    failed: int
    seconds: float
    names: tuple[str, ...]


def parse(output: str, exit_code: int, seconds: float) -> Run:
    """Return the counts in pytest's output; a run that ended without any, or with an error, counts as failed."""
    counts = {kind.rstrip("s"): int(number) for number, kind in _COUNT.findall(output.strip().rpartition("\n")[2])}
    names = tuple(_FAILED.findall(output))
    failed = max(counts.get("failed", 0) + counts.get("error", 0), len(names), int(exit_code != 0))
    return Run(counts.get("passed", 0), failed, seconds, names)


def row(number: int, loops: int, run: Run) -> str:
    """Return a run's row of the table."""
    names = ", ".join(f"`{name}`" for name in run.names)
    return f"| {number} | {loops} | {run.passed} | {run.failed} | {run.seconds:.0f} | {names} |"


@contextmanager
def busy(loops: int) -> Iterator[None]:
    """Keep so many processors busy meanwhile, also if Ctrl-C ends it."""
    children = [subprocess.Popen([sys.executable, "-S", "-c", _BUSY]) for _ in range(loops)]
    try:
        yield
    finally:
        for child in children:
            child.kill()
            child.wait()


def run_tests(words: Sequence[str]) -> Run:
    """Run the default tests once, with further words for pytest."""
    began_s = time.monotonic()
    command = [sys.executable, "-m", "pytest", "-q", *WORKERS, *words]
    ended = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    run = parse(ended.stdout, ended.returncode, time.monotonic() - began_s)
    if run.failed:
        print(ended.stdout, file=sys.stderr)
    return run


def main() -> int:
    """Run the tests as the command line says; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tests.many_runs", description=__doc__)
    parser.add_argument("--runs", type=int, default=20, help="number of runs")
    parser.add_argument("--busy", type=int, default=10, help="number of them next to busy loops")
    parser.add_argument("words", nargs="*", help="words for pytest")
    options = parser.parse_args()
    print(HEAD, flush=True)
    failed = 0
    for number in range(1, options.runs + 1):
        loops = LOOPS if number > options.runs - options.busy else 0
        with busy(loops):
            run = run_tests(options.words)
        failed += run.failed
        print(row(number, loops, run), flush=True)
    return int(failed > 0)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
