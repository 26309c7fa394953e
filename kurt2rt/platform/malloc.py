"""Memory that was needed once goes back to the machine, and does not become gaps."""

import ctypes

_M_MMAP_THRESHOLD = -3
"""Of malloc.h."""
_LARGE_BYTES = 128 * 1024


def pin_mmap_threshold() -> None:
    """Let what is taken in a piece of 128 kB or more leave no gap when it is no more needed, for the whole program.

    So the C library begins, too. But with the first large piece that is given back it raises its bound up to that
    size: whatever reads knowledge at the start then makes gaps between what stays, for as long as the program runs.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:  # others than glibc have no such bound
        mallopt(_M_MMAP_THRESHOLD, _LARGE_BYTES)
