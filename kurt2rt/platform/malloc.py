"""Return of large freed blocks from glibc's heap to the operating system."""

import ctypes

_M_MMAP_THRESHOLD = -3
"""M_MMAP_THRESHOLD of glibc's malloc.h."""
_LARGE_BYTES = 128 * 1024


def pin_mmap_threshold() -> None:
    """Pin glibc's mmap threshold at 128 kB, so that freed large blocks return to the operating system.

    128 kB is glibc's default, but the first large block that is freed raises the threshold to its size. Reading
    knowledge at the start would then fragment the heap for as long as the program runs. No-op on other libcs.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:  # missing in libcs other than glibc
        mallopt(_M_MMAP_THRESHOLD, _LARGE_BYTES)
