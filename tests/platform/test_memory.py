"""Memory of the program: freed large blocks return to the operating system, and what stays lies on huge pages."""

import subprocess
import sys
from pathlib import Path

import pytest

from kurt2rt.platform import memory

_RESIDENT = """
import os
from pathlib import Path

def resident_mb():
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
"""

_BLOCKS = """
from kurt2rt.platform.memory import pin_mmap_threshold

pin_mmap_threshold()
first = bytearray(8_000_000)
del first
before_mb = resident_mb()
large = bytearray(b"x" * 4_000_000)
small = [bytes(1000) for _ in range(10)]
del large
print(resident_mb() - before_mb)
"""

_SMALL_OBJECTS = """
from kurt2rt.platform.memory import use_huge_pages

kept = [str(number) * 20 for number in range(200_000)]
before_mb = resident_mb()
claimed_kb = use_huge_pages() // 1024
told = Path("/proc/self/smaps").read_text().splitlines()
print(claimed_kb, sum(int(line.split()[1]) for line in told if line.startswith("AnonHugePages")))
print(resident_mb() - before_mb, kept == [str(number) * 20 for number in range(200_000)])
"""


def _told(story: str) -> list[str]:
    words = [sys.executable, "-c", _RESIDENT + story]
    return subprocess.run(words, capture_output=True, text=True, check=True, timeout=60).stdout.split()


def test_pin_mmap_threshold_returns_large_blocks() -> None:
    assert float(_told(_BLOCKS)[0]) < 2.0


def test_use_huge_pages_moves_what_is_there_and_takes_no_more() -> None:
    claimed_kb, huge_kb, grown_mb, unchanged = _told(_SMALL_OBJECTS)
    assert int(claimed_kb) <= int(huge_kb)  # 0 before Linux 6.1
    assert float(grown_mb) < 8.0
    assert unchanged == "True"


def test_use_huge_pages_does_without_proc(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "_SMAPS", tmp_path / "hidden")
    assert memory.use_huge_pages() == 0
