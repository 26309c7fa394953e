"""Longer deadlines of a shutdown: a machine that stalls while a program ends is no disk that hangs.

tests/service/test_shutdown.py keeps the real ones, in programs of their own interpreter.
"""

import pytest

from kurt2rt.service import shutdown

_KEPT_BACK_S = 2.0
_NEVER_S = 60.0


def extend_deadlines(patch: pytest.MonkeyPatch, wait_s: float = 3.0) -> None:
    """Let the parts of a program end within `wait_s` of its signal, and the program 2 s later."""
    patch.setattr(shutdown, "_KEPT_BACK_S", _KEPT_BACK_S)
    patch.setattr(shutdown, "_GIVES_UP_S", wait_s + _KEPT_BACK_S)
    patch.setattr(shutdown, "LONGEST_S", _NEVER_S)  # ends an interpreter that hangs as a whole, as none of these does
