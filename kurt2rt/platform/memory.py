"""Memory of the program: freed large blocks return to the operating system, and the rest lies on huge pages."""

import ctypes
import re
from pathlib import Path

_M_MMAP_THRESHOLD = -3
"""M_MMAP_THRESHOLD of glibc's malloc.h."""
_LARGE_BYTES = 128 * 1024

_MADV_COLLAPSE = 25
"""MADV_COLLAPSE of Linux 6.1 and newer."""
_HUGE_BYTES = 2 * 1024 * 1024
_SMAPS = Path("/proc/self/smaps")
_MAPPING = re.compile(r"^(\w+)-(\w+) rw-p \w+ 00:00 0 +(?:\[heap\])?\nSize: +(\d+) kB\n(?:.*\n)*?Rss: +(\d+) kB", re.M)
"""Anonymous memory of this process in /proc/self/smaps: begin, end, size, and what of it is there."""


def pin_mmap_threshold() -> None:
    """Pin glibc's mmap threshold at 128 kB, so that freed large blocks return to the operating system.

    128 kB is glibc's default, but the first large block that is freed raises the threshold to its size. Reading
    knowledge at the start would then fragment the heap for as long as the program runs. No-op on other libcs.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:  # missing in libcs other than glibc
        mallopt(_M_MMAP_THRESHOLD, _LARGE_BYTES)


def use_huge_pages() -> int:
    """Move memory that is in use to pages of 2 MB, as far as Linux can; return the bytes that lie on them now.

    After each wait of 10 ms a tick has to look up most of its addresses again. With fewer pages it takes a tenth less
    time. Before the first tick only, because it takes some 0.1 s. No-op before Linux 6.1, and where /proc is hidden.
    """
    try:
        mappings = _MAPPING.findall(_SMAPS.read_text(encoding="utf-8"))
    except OSError:
        return 0
    madvise = ctypes.CDLL(None).madvise
    madvise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
    huge = 0
    for begin, end, size, used in mappings:
        # Half empty ones, such as stacks, would take far more memory than now.
        if 2 * int(used) < int(size):
            continue
        first = -(-int(begin, 16) // _HUGE_BYTES) * _HUGE_BYTES
        for page in range(first, int(end, 16) - _HUGE_BYTES + 1, _HUGE_BYTES):
            if madvise(page, _HUGE_BYTES, _MADV_COLLAPSE) == 0:
                huge += _HUGE_BYTES
    return huge
