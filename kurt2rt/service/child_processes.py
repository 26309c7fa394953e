"""Child processes of the robot program: the teacher's page, the scripted teacher."""

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

POLL_S = 1.0
"""Period of the checks whether children run, and first delay of a restart, in s."""
LONGEST_PAUSE_S = 30.0
"""Longest delay of a restart, in s. Each delay is twice the one before, unless the child ran longer than this."""
_ENDING_S = 5.0
_LAST_LINES_S = 0.5
"""Time to read the last lines of a child that ended, in s."""
_PROGRAM = (sys.executable, "-P", "-m", "kurt2rt.cli.with_parent")
"""Words that start the command line. Without -P the present folder would be searched for modules."""


@dataclass
class _Child:
    """One child process and its restart."""

    name: str
    command: tuple[str, ...]
    restarts: bool
    """True if it is started again if it ends."""
    pause_s: float
    on_line: Callable[[str], None]
    """Gets each line that it prints, from a thread."""
    restart_at_s: float | None = None
    """Time of the next restart, monotonic s; None while it runs, or if it is not restarted."""
    trouble: str = ""

    def start(self) -> None:
        """Start the process, and the thread that reads its lines. Raises OSError."""
        self.process = _started(self.command)
        self.reader = _read(self.process, self.on_line)
        self.started_s, self.restart_at_s, self.trouble = time.monotonic(), None, ""


class ChildProcesses:
    """Child processes that run kurt2rt commands, restarted if they fail and ended with this process.

    Each has a session of its own, so that Ctrl-C reaches the robot first. Its standard input is a pipe from this
    process: it ends with this process, and so does the child. Its output is a pipe to this process, because the
    terminal has lines that stay in place.
    """

    def __init__(
        self,
        remaining_s: Callable[[float], float] = lambda most_s: most_s,
        log: Callable[[str], None] = lambda _: None,
        start: tuple[str, ...] = _PROGRAM,
        poll_s: float = POLL_S,
    ) -> None:
        """Start no process yet.

        Args:
            remaining_s: returns the time that is left for a wait of the given length, in s.
            log: gets a line if a child ends, from a thread.
            start: words that start kurt2rt, in a process that ends with its standard input.
            poll_s: period of the checks, and first delay of a restart, in s.
        """
        self._remaining_s = remaining_s
        self._log = log
        self._program = start
        self._poll_s = poll_s
        self._children: list[_Child] = []
        self._ends = threading.Event()
        # A daemon, because a fork may hang with the disk.
        self._looking = threading.Thread(target=self._poll_all, name="children", daemon=True)

    @property
    def trouble(self) -> str:
        """Line that names the children that do not run, and what happens next; empty while all run."""
        return ", ".join(each.trouble for each in self._children if each.trouble)

    def start(self, name: str, *words: str, restarts: bool, on_line: Callable[[str], None] | None = None) -> None:
        """Start `kurt2rt WORDS`, which ends with this process.

        Args:
            name: name of the child in the log.
            words: command and options.
            restarts: whether it is started again whenever it ends; otherwise `trouble` tells a failure.
            on_line: gets each line that it prints, from a thread; None: the log gets them.

        Raises:
            OSError: the process cannot be started.
        """
        child = _Child(name, (*self._program, *words), restarts, self._poll_s, on_line or self._log)
        child.start()
        self._children.append(child)

    def __enter__(self) -> Self:
        self._looking.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._looking.join(self._remaining_s(_ENDING_S))
        processes = [each.process for each in self._children]
        for process in processes:
            assert process.stdin is not None
            process.stdin.close()  # it ends as by SIGTERM; a second signal would cut its last acts short
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

    def _poll(self, child: _Child, now_s: float) -> None:
        if child.restart_at_s is not None:
            if now_s >= child.restart_at_s:
                self._restart(child, now_s)
            return
        code = child.process.poll()
        if code is None or child.trouble or (code == 0 and not child.restarts):
            return
        child.reader.join(_LAST_LINES_S)
        ended = f"{child.name} ended ({f'signal {-code}' if code < 0 else f'exit code {code}'})"
        if not child.restarts:
            child.trouble = f"{ended}; start it again by hand"
        else:
            if now_s - child.started_s > LONGEST_PAUSE_S:
                child.pause_s = self._poll_s
            child.restart_at_s = now_s + child.pause_s
            child.trouble = f"{ended}; it is started again in {child.pause_s:g} s"
            child.pause_s = min(2 * child.pause_s, LONGEST_PAUSE_S)
        self._log(child.trouble)

    def _restart(self, child: _Child, now_s: float) -> None:
        assert child.process.stdin is not None
        child.process.stdin.close()
        try:
            child.start()
        except OSError as error:
            child.trouble = f"{child.name} cannot be started ({error}); kurt2rt has to be installed whole"
            child.restart_at_s = now_s + LONGEST_PAUSE_S
            self._log(child.trouble)


def _started(command: tuple[str, ...]) -> "subprocess.Popen[bytes]":
    return subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        env={**os.environ, "PYTHONUNBUFFERED": "1", "COLUMNS": "10000"},  # each message in a line
        start_new_session=True,
    )


def _read(process: "subprocess.Popen[bytes]", hear: Callable[[str], None]) -> threading.Thread:
    def read() -> None:
        assert process.stdout is not None
        with process.stdout as lines:
            for line in lines:
                hear(line.decode(errors="replace").rstrip())

    thread = threading.Thread(target=read, name="child's lines", daemon=True)
    thread.start()
    return thread
