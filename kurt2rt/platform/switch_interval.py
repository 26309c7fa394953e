"""Switch interval of the interpreter that suits a 10 ms tick."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

_TURN_S = 0.0005
"""The default of 5 ms is half a tick: a thread that computes could delay the loop by that."""


@contextmanager
def short_switch_interval() -> Iterator[None]:
    """Set Python's thread switch interval to 0.5 ms in the block, and restore it at the end."""
    before_s = sys.getswitchinterval()
    sys.setswitchinterval(_TURN_S)
    try:
        yield
    finally:
        sys.setswitchinterval(before_s)
