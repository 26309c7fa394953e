"""Threads of this process wait for one another only for moments."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

_TURN_S = 0.0005
"""The interpreter's own 5 ms are half a tick: so long a thread that computes could keep the loop waiting."""


@contextmanager
def short_switch_interval() -> Iterator[None]:
    """Let the interpreter change threads more often than it would."""
    before_s = sys.getswitchinterval()
    sys.setswitchinterval(_TURN_S)
    try:
        yield
    finally:
        sys.setswitchinterval(before_s)
