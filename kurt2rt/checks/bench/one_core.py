"""Restriction to one core."""

import os
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def on_one_core() -> Iterator[int]:
    """Restrict this thread and its children to one of its allowed cores; yield the core."""
    before = os.sched_getaffinity(0)
    core = max(before)  # interrupts mostly come to the first one
    os.sched_setaffinity(0, {core})
    try:
        yield core
    finally:
        os.sched_setaffinity(0, before)
