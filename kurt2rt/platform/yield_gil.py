"""Long work of another thread in slices, so that the robot's loop gets the GIL."""

import threading
import time
from collections.abc import Iterable, Iterator
from typing import TypeVar

SLICE_S = 0.0005
PAUSE_S = 0.0005
"""Long enough for the loop to wake up; the interpreter switches threads only every 5 ms, half a tick."""

_Item = TypeVar("_Item")


def yield_gil(items: Iterable[_Item]) -> Iterator[_Item]:
    """Yield the items and sleep after each slice, so that the loop's thread gets the GIL.

    The main thread, which runs the loop, does not sleep.
    """
    if threading.current_thread() is threading.main_thread():
        yield from items
        return
    slice_ends = time.perf_counter() + SLICE_S
    for item in items:
        yield item
        if time.perf_counter() >= slice_ends:
            time.sleep(PAUSE_S)
            slice_ends = time.perf_counter() + SLICE_S
