"""Memory of a start: freed large blocks return to the operating system."""

import subprocess
import sys

_STORY = """
import os
from pathlib import Path
from kurt2rt.platform.malloc import pin_mmap_threshold

def resident_mb():
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6

pin_mmap_threshold()
first = bytearray(8_000_000)
del first
before_mb = resident_mb()
large = bytearray(b"x" * 4_000_000)
small = [bytes(1000) for _ in range(10)]
del large
print(resident_mb() - before_mb)
"""


def test_pin_mmap_threshold_returns_large_blocks() -> None:
    told = subprocess.run([sys.executable, "-c", _STORY], capture_output=True, text=True, check=True, timeout=60)
    assert float(told.stdout) < 2.0
