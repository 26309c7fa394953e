"""One core for a while."""

import os
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def on_one_core() -> Iterator[int]:
    """Keep this thread, and those it starts, to one of the cores it may use; yields which."""
    before = os.sched_getaffinity(0)
    core = max(before)  # interrupts mostly come to the first one
    os.sched_setaffinity(0, {core})
    try:
        yield core
    finally:
        os.sched_setaffinity(0, before)
