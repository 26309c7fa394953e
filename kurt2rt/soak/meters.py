"""What the program takes of its machine."""

import ctypes
import gc
import os
import threading
from collections import Counter
from pathlib import Path

_STATM = Path("/proc/self/statm")
_FD = Path("/proc/self/fd")
_MB = 1e6


def resident_mb() -> float:
    """Memory that is in use now, in 10^6 bytes; what the allocator holds and nobody uses is given back first."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
    pages = int(_STATM.read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / _MB


def open_files() -> int:
    """File descriptors."""
    return sum(1 for _ in _FD.iterdir())


def threads() -> int:
    """Of Python."""
    return threading.active_count()


def objects_by_type(most: int = 40) -> dict[str, int]:
    """How many objects of which types the collector knows, the most frequent ones. Takes a moment."""
    counted = Counter(type(each).__qualname__ for each in gc.get_objects())
    return dict(counted.most_common(most))
