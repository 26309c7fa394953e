"""Long work in a thread beside the robot's loop, in small bites."""

import threading
import time
from collections.abc import Iterable, Iterator
from typing import TypeVar

SLICE_S = 0.0005
PAUSE_S = 0.0005
"""Long enough for the loop to wake and take over; Python by itself hands over every 5 ms only, half a tick."""

_Item = TypeVar("_Item")


def yield_gil(items: Iterable[_Item]) -> Iterator[_Item]:
    """The same items, with a pause after each bite: the loop's thread is not kept waiting for the interpreter.

    The loop has the main thread: who works there keeps nobody waiting, and makes no pauses.
    """
    if threading.current_thread() is threading.main_thread():
        yield from items
        return
    bite_ends = time.perf_counter() + SLICE_S
    for item in items:
        yield item
        if time.perf_counter() >= bite_ends:
            time.sleep(PAUSE_S)
            bite_ends = time.perf_counter() + SLICE_S
