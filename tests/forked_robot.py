"""Robot processes forked from the session's fork server, which saves each test a second of importing."""

import os
from collections.abc import Sequence
from pathlib import Path
from subprocess import Popen
from typing import IO, cast

import pytest

from kurt2rt.teacher.client import robot_process
from tests.forked_program import ForkedProcess, has_fork_server


class ForkedRobot(ForkedProcess):
    """Stand-in for the Popen of a RobotProcess: a pipe to its standard input, its output in a file."""

    def __init__(self, words: Sequence[str], folder: Path, log: Path, environment: dict[str, str]) -> None:
        keyboard, stdin = os.pipe()
        self.stdin: IO[bytes] = os.fdopen(stdin, "wb")
        with log.open("wb") as output:
            streams = (keyboard, output.fileno(), output.fileno())
            try:
                super().__init__(robot_process.PROGRAM, words, folder, environment, streams)
            finally:
                os.close(keyboard)


def fork_robots(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fork each RobotProcess that is started from now on, if the session has a fork server."""

    def started(words: Sequence[str], folder: Path, log: Path, environment: dict[str, str]) -> "Popen[bytes]":
        return cast("Popen[bytes]", ForkedRobot(words, folder, log, environment))

    if has_fork_server():
        monkeypatch.setattr(robot_process, "_started", started)
