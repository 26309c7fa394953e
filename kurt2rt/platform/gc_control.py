"""Garbage collection between ticks only, and of the objects of one job only."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

_BY_INTERPRETER = gc.get_freeze_count()
"""Objects that Python itself has frozen at its start: some hundreds in 3.12, none in 3.11 and 3.13."""


@contextmanager
def gc_frozen() -> Iterator[None]:
    """Collect now, then not again in the block; freeze the objects that exist, so that no collection walks them.

    Reference counting goes on: only cycles stay until the end of the block.
    """
    was_enabled = gc.isenabled()
    try:
        with unfrozen_at_end():
            gc.collect()
            gc.freeze()
            gc.disable()
            yield
    finally:
        if was_enabled:
            gc.enable()


@contextmanager
def unfrozen_at_end() -> Iterator[None]:
    """Unfreeze all objects at the end of the block, unless the program had frozen some before it."""
    ours_before = gc.get_freeze_count() > _BY_INTERPRETER
    try:
        yield
    finally:
        if not ours_before:
            gc.unfreeze()


def freeze_survivors() -> None:
    """Collect the cycles among the objects made since the last call, and let no later collection walk the others.

    For a process that does one job after the other: else each full collection walks all imported packages.
    `unfrozen_at_end` ends it.
    """
    gc.collect()
    gc.freeze()


def collect_young() -> None:
    """Collect the cycles among the youngest objects, in a fraction of a millisecond; call it between two ticks.

    Network libraries leave cycles with each message. Objects frozen by `gc_frozen` are not walked.
    """
    gc.collect(1)
