"""A program whose system calls on some files fail when they are told to, by strace."""

import re
import shutil
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.cli.helpers import started

CALLS = (
    *("openat", "newfstatat", "read", "pread64", "write", "pwrite64", "ftruncate", "fsync", "fdatasync", "rename"),
    *("unlink", "fcntl", "flock", "lseek", "mmap", "close"),
)
"""System calls of Python and SQLite on files."""
_CALL = re.compile(r"^(\d+) +(\w+)\(")


@dataclass(frozen=True, slots=True)
class FailingCall:
    """The call of that name and number, from 1, fails; each thread counts for itself."""

    name: str
    number: int
    error: str

    def __str__(self) -> str:
        return f"{self.name} {self.number} {self.error}"


@dataclass(frozen=True, slots=True)
class Ended:
    """Exit code and output of a program that ended."""

    exit_code: int
    out: str
    err: str


def require_strace() -> None:
    """Skip where there is none, or where it may not trace."""
    if shutil.which("strace") is None:
        pytest.skip("needs strace (Debian: apt-get install strace)")
    if subprocess.run(["strace", "-o", "/dev/null", "true"], capture_output=True, check=False).returncode:
        pytest.skip("strace may not trace here (ptrace is forbidden)")


def calls_made(module: str, knowledge: Path, log: Path) -> Counter[str]:
    """Run a module on a knowledge file; how often the thread that makes a call most often makes it."""
    _run(module, knowledge, log, [])
    by_thread: Counter[tuple[str, str]] = Counter()
    for line in log.read_text(encoding="utf-8", errors="replace").splitlines():
        found = _CALL.match(line)
        if found is not None:
            by_thread[found.group(1), found.group(2)] += 1
    made: Counter[str] = Counter()
    for (_, name), count in by_thread.items():
        made[name] = max(made[name], count)
    return made


def run_failing(module: str, knowledge: Path, log: Path, failing: FailingCall) -> Ended:
    """Run a module on a knowledge file with one call that fails."""
    inject = f"inject={failing.name}:error={failing.error}:when={failing.number}"
    return _run(module, knowledge, log, ["-e", inject])


def run_sound(module: str, knowledge: Path) -> Ended:
    """Run it as it is."""
    with started(module, str(knowledge), folder=knowledge.parent) as program:
        out, err = program.communicate()
        return Ended(program.wait(), out, err)


def _run(module: str, knowledge: Path, log: Path, options: list[str]) -> Ended:
    names = [f"{knowledge}{ending}" for ending in ("", "-wal", "-shm", "-journal", ".lock")]
    watched = [*names, str(knowledge.with_name(f".{knowledge.name}.unborn")), str(knowledge.parent)]
    words = ["strace", "-f", "-qq", "--seccomp-bpf", "-o", str(log), "-e", f"trace={','.join(CALLS)}", *options]
    for each in watched:
        words += ["-P", each]
    words += [sys.executable, "-m", module, str(knowledge)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    return Ended(done.returncode, done.stdout, done.stderr)
