"""`kurt2rt run ...` in which one thing hangs for ever: python -m tests.service.hanging_program THING run ..."""

import sys
import threading
from typing import Any, Never

import pytest

from kurt2rt.channel.security.paired_devices import Teachers
from kurt2rt.channel.server.endpoint import Endpoint
from kurt2rt.cli.main import main
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.runs.recording.run_files import RunFiles
from kurt2rt.service import program_startup
from kurt2rt.service.post_tick import PostTick
from tests.patient_shutdown import extend_deadlines

_WAIT_S = 0.7
"""Time for a part that hangs to end: the real one; what comes after it has longer than in truth."""


def _hang(*_: Any, **__: Any) -> Never:
    while True:
        threading.Event().wait()


async def _hang_in_the_loop(*_: Any) -> None:
    _hang()


def _let_hang(thing: str) -> None:
    hangs: dict[str, tuple[object, str, object]] = {
        "start": (program_startup, "open_for_teaching", _hang),
        "disk": (Journal, "checkpoint", _hang),
        "recorder": (RunFiles, "poll", _hang),
        "keys": (Teachers, "close", _hang),
        "network": (Endpoint, "close", _hang_in_the_loop),
        "loop": (PostTick, "save_statistics", _hang),
    }
    owner, name, replacement = hangs[thing]
    assert hasattr(owner, name)  # a name that moved would let the program run on
    setattr(owner, name, replacement)


if __name__ == "__main__":
    extend_deadlines(pytest.MonkeyPatch(), _WAIT_S)
    _let_hang(sys.argv.pop(1))
    main()
