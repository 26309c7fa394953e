"""Programs that run beside the robot's: the teacher's page, the scripted teacher."""

import os
import subprocess
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType
from typing import Self

from kurt2rt.service.systemd.installation import start_command

POLL_S = 1.0
"""Between two looks whether they are there, and before one that ended is started anew."""
LONGEST_PAUSE_S = 30.0
"""That is twice as long each time, up to this, and as at first after one that lasted longer."""
_ENDING_S = 5.0
_LAST_LINES_S = 0.5
"""For what one that ended had still printed."""


@dataclass
class _Companion:
    """One of them."""

    name: str
    command: tuple[str, ...]
    restarts: bool
    """It has no end of its own: one that ended is started anew."""
    process: "subprocess.Popen[bytes]"
    started_s: float
    pause_s: float
    on_line: Callable[[str], None]
    """Takes each line that it prints; from a thread."""
    reader: threading.Thread
    restart_at_s: float | None = None
    """When to start it anew; None while it runs, or has ended for good."""
    trouble: str = ""


class ChildProcesses:
    """Starts kurt2rt commands as processes of their own, looks after them and ends them with this one.

    In sessions of their own, so that Ctrl-C reaches the robot first. Their standard input is a pipe from here: it ends
    when this process is gone, however that came, and so do they. What they print is a pipe to here, for the terminal
    has lines that stay in place.
    """

    def __init__(
        self,
        settings: str,
        patience_s: Callable[[float], float] = lambda most_s: most_s,
        tell: Callable[[str], None] = lambda _: None,
        start: tuple[str, ...] | None = None,
        look_s: float = POLL_S,
    ) -> None:
        """`settings`: runtime settings, as given on the command line.

        `patience_s`: how long they may be waited for at the end, of what they would like. `tell` takes a line when one
        ends; from a thread. `start`: the words that start kurt2rt; those of this installation unless given. `look_s`:
        between two looks, and before a first new start.
        """
        self._remaining_s = patience_s
        self._settings = settings
        self._log = tell
        self._program = start_command() if start is None else start
        self._poll_s = look_s
        self._children: list[_Companion] = []
        self._ends = threading.Event()
        # A daemon, for a fork may hang with the disk.
        self._looking = threading.Thread(target=self._poll_all, name="companions", daemon=True)

    @property
    def trouble(self) -> str:
        """Who of them is not there, and what becomes of it, in a line; empty while all are."""
        return ", ".join(each.trouble for each in self._children if each.trouble)

    def start(self, name: str, *words: str, lasts: bool, hear: Callable[[str], None] | None = None) -> None:
        """Start `kurt2rt WORDS`. `lasts`: it has no end of its own, so it is started again when it ended.

        `hear` takes each line that it prints, from a thread; such a line is told unless that is given.
        """
        command = (*self._program, *words, "--settings", self._settings, "--while-stdin")
        process, heard = _started(command), hear or self._log
        reader = _read(process, heard)
        companion = _Companion(name, command, lasts, process, time.monotonic(), self._poll_s, heard, reader)
        self._children.append(companion)

    def __enter__(self) -> Self:
        self._looking.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ends.set()
        self._looking.join(self._remaining_s(_ENDING_S))
        processes = [each.process for each in self._children]
        for process in processes:
            assert process.stdin is not None
            process.stdin.close()
            process.terminate()
        for process in processes:
            try:
                process.wait(self._remaining_s(_ENDING_S))
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def _poll_all(self) -> None:
        while not self._ends.wait(self._poll_s):
            for each in tuple(self._children):
                self._poll(each, time.monotonic())

    def _poll(self, companion: _Companion, now_s: float) -> None:
        if companion.restart_at_s is not None:
            if now_s >= companion.restart_at_s:
                self._restart(companion, now_s)
            return
        code = companion.process.poll()
        if code is None or companion.trouble or (code == 0 and not companion.restarts):
            return
        companion.reader.join(_LAST_LINES_S)
        ended = f"{companion.name} ended ({_cause(code)})"
        if not companion.restarts:
            companion.trouble = f"{ended}; start it again by hand"
        else:
            if now_s - companion.started_s > LONGEST_PAUSE_S:
                companion.pause_s = self._poll_s
            companion.restart_at_s = now_s + companion.pause_s
            companion.trouble = f"{ended}; it is started anew in {companion.pause_s:g} s"
            companion.pause_s = min(2 * companion.pause_s, LONGEST_PAUSE_S)
        self._log(companion.trouble)

    def _restart(self, companion: _Companion, now_s: float) -> None:
        assert companion.process.stdin is not None
        companion.process.stdin.close()
        try:
            companion.process = _started(companion.command)
        except OSError as error:
            companion.trouble = f"{companion.name} cannot be started ({error}); kurt2rt has to be installed whole"
            companion.restart_at_s = now_s + LONGEST_PAUSE_S
            self._log(companion.trouble)
        else:
            companion.reader = _read(companion.process, companion.on_line)
            companion.started_s, companion.restart_at_s, companion.trouble = now_s, None, ""


def _started(command: tuple[str, ...]) -> "subprocess.Popen[bytes]":
    return subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
        start_new_session=True,
    )


def _read(process: "subprocess.Popen[bytes]", hear: Callable[[str], None]) -> threading.Thread:
    def read() -> None:
        assert process.stdout is not None
        with process.stdout as lines:
            for line in lines:
                hear(line.decode(errors="replace").rstrip())

    thread = threading.Thread(target=read, name="companion's lines", daemon=True)
    thread.start()
    return thread


def _cause(code: int) -> str:
    return f"signal {-code}" if code < 0 else f"exit code {code}"
