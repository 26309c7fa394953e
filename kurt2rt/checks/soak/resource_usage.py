"""Resources that the program takes of its machine."""

import ctypes
import gc
import sys
import threading
from collections import Counter

import psutil

_MB = 1e6
_USUAL_OBJECT_BYTES = 95
"""Mean size of a block of Python's allocator, measured in soaks."""


_MALLINFO = (
    *("arena", "ordblks", "smblks", "hblks", "hblkhd"),
    *("usmblks", "fsmblks", "uordblks", "fordblks", "keepcost"),
)


class _MallInfo(ctypes.Structure):
    """glibc's `struct mallinfo2`."""

    _fields_ = tuple((name, ctypes.c_size_t) for name in _MALLINFO)


def resident_mb() -> float:
    """Return the resident memory in 10^6 bytes, after free heap memory was returned to the OS."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
    return float(psutil.Process().memory_info().rss) / _MB


def used_mb() -> float:
    """Return the memory of live objects in MB without heap gaps, to some percent."""
    # Python's own allocator tells how many small objects it holds, and the C library how much all else takes.
    told = getattr(ctypes.CDLL(None), "mallinfo2", None)
    if told is None:
        return resident_mb()
    told.restype = _MallInfo
    info = told()
    return (int(info.uordblks) + int(info.hblkhd) + sys.getallocatedblocks() * _USUAL_OBJECT_BYTES) / _MB


def open_files() -> int:
    """Return the number of open file descriptors of this process."""
    return int(psutil.Process().num_fds())


def threads() -> int:
    """Return the number of Python threads of this process."""
    return threading.active_count()


def objects_by_type(most: int = 40) -> dict[str, int]:
    """Return the number of objects by type name, of the `most` frequent types of the garbage collector. Slow."""
    counted = Counter(type(each).__qualname__ for each in gc.get_objects())
    return dict(counted.most_common(most))
