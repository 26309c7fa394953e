"""A terminal of 80 columns for a program, and what stands on it at the end."""

import os
import re
import signal
import struct
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from fcntl import ioctl
from pathlib import Path
from termios import TIOCSWINSZ

from tests.forked_program import ForkedProcess, has_fork_server

_STEP = re.compile(r"\x1b\[([\d;]*)([A-Za-z])|\x1b\[\?\d+[hl]|(\r)|(\n)|([^\x1b\r\n]+)")


class Terminal:
    """A screen without end, as a terminal with scroll-back: understands what rich sends."""

    def __init__(self) -> None:
        self.lines = [""]
        self._row = 0
        self._column = 0

    def feed(self, text: str) -> None:
        """Do what is sent to it."""
        for step in _STEP.finditer(text):
            count, command, to_begin, down, shown = step.groups()
            if command == "A":
                self._row = max(0, self._row - int(count or 1))
            elif command == "K":
                self.lines[self._row] = ""
            elif to_begin:
                self._column = 0
            elif down:
                self._row += 1
                self._column = 0
                if self._row == len(self.lines):
                    self.lines.append("")
            elif shown:
                line = self.lines[self._row].ljust(self._column)
                self.lines[self._row] = line[: self._column] + shown + line[self._column + len(shown) :]
                self._column += len(shown)


class ProgramInTerminal:
    """`kurt2rt ...` in a terminal of 80 columns."""

    def __init__(self, words: Sequence[str], folder: Path, environment: Mapping[str, str], *, rows: int = 24) -> None:
        self.sent = ""
        """All that it sent to the terminal so far."""
        self._ours, theirs = os.openpty()
        ioctl(theirs, TIOCSWINSZ, struct.pack("HHHH", rows, 80, 0, 0))
        environment = {**os.environ, "TERM": "xterm-256color", **environment}
        for name in ("COLUMNS", "LINES", "NO_COLOR"):
            environment.pop(name, None)
        self._process: ForkedProcess | subprocess.Popen[bytes]
        if has_fork_server():
            self._process = ForkedProcess("kurt2rt.cli.main", list(words), folder, environment, (theirs,) * 3)
        else:
            command = [sys.executable, "-m", "kurt2rt.cli.main", *words]
            self._process = subprocess.Popen(
                command, cwd=folder, env=environment, stdin=theirs, stdout=theirs, stderr=theirs
            )
        os.close(theirs)

    def read_until(self, there: Callable[[str], bool]) -> None:
        """Read on until `there` is true of all that it has sent."""
        while not there(self.sent):
            self._read()

    def end(self) -> int:
        """Send SIGINT and read to the end; returns the exit code."""
        self._process.send_signal(signal.SIGINT)
        with suppress(OSError):  # EIO: no program has it open any more
            while True:
                self._read()
        os.close(self._ours)
        return self._process.wait()

    def _read(self) -> None:
        if not (piece := os.read(self._ours, 65536)):
            raise OSError("it ended")
        self.sent += piece.decode(errors="replace")
