"""Programs that run beside the robot's: the teacher's page, the scripted teacher."""

import os
import subprocess
import sys
from collections.abc import Callable
from types import TracebackType
from typing import Self

_ENDING_S = 5.0


def _give_way() -> None:
    """The loop may run at a real-time priority; who keeps it company must not hold it up."""
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


class Companions:
    """Starts kurt2rt commands as processes of their own and ends them with this one.

    In sessions of their own, so that Ctrl-C reaches the robot first. Their standard input is a pipe from here: it ends
    when this process is gone, however that came, and so do they.
    """

    def __init__(self, settings: str, patience_s: Callable[[float], float] = lambda most_s: most_s) -> None:
        """`settings`: runtime settings, as given on the command line.

        `patience_s`: how long they may be waited for at the end, of what they would like.
        """
        self._patience_s = patience_s
        self._settings = settings
        self._processes: list[subprocess.Popen[bytes]] = []

    def start(self, *words: str) -> None:
        """Start `kurt2rt WORDS`."""
        command = [sys.executable, "-m", "kurt2rt.cli.main", *words, "--settings", self._settings, "--while-stdin"]
        self._processes.append(
            subprocess.Popen(command, stdin=subprocess.PIPE, start_new_session=True, preexec_fn=_give_way)
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for process in self._processes:
            assert process.stdin is not None
            process.stdin.close()
            process.terminate()
        for process in self._processes:
            try:
                process.wait(self._patience_s(_ENDING_S))
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
