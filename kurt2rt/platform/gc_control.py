"""No garbage collection while it must not stall a tick."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def gc_frozen() -> Iterator[None]:
    """Collect now, then not again until the end; what exists is set aside until then, so that no collection walks it.

    Reference counting goes on: only cycles wait.
    """
    was_enabled = gc.isenabled()
    frozen_before = gc.get_freeze_count()
    gc.collect()
    gc.freeze()
    gc.disable()
    try:
        yield
    finally:
        if frozen_before == 0:  # an outer one keeps what it set aside
            gc.unfreeze()
        if was_enabled:
            gc.enable()


def collect_young() -> None:
    """Collect the cycles among what was made lately; a fraction of a millisecond, for between two ticks.

    Network libraries leave cycles behind with each message. What was set aside by `gc_frozen` is not walked.
    """
    gc.collect(1)
