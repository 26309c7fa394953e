"""Lines of keyboard input without blocking the event loop."""

import io
import os
import stat
import termios
from typing import TextIO

import anyio

_CHUNK = 4096


class Keyboard:
    """Line reader that discards input typed before the question.

    A key hit too early must not turn the wheels.
    """

    def __init__(self, lines: TextIO) -> None:
        self._lines = lines
        self._fd = _descriptor(lines)
        self._waiting = b""

    @property
    def echoes(self) -> bool:
        """Return whether the terminal shows the typed text."""
        return self._fd is not None and os.isatty(self._fd)

    async def line(self) -> str | None:
        """Return the next line without its end; None at the end of input. Piped lines are not discarded."""
        if self._fd is None:
            text = self._lines.readline()
            return text.rstrip("\r\n") if text else None
        if self.echoes:
            termios.tcflush(self._fd, termios.TCIFLUSH)
            self._waiting = b""
        while b"\n" not in self._waiting:
            await anyio.wait_readable(self._fd)
            chunk = os.read(self._fd, _CHUNK)
            if not chunk:
                return None
            self._waiting += chunk
        line, _, self._waiting = self._waiting.partition(b"\n")
        return line.decode("utf-8", errors="replace").rstrip("\r")


def _descriptor(lines: TextIO) -> int | None:
    """Return the descriptor of a terminal, pipe or socket; None for input that never blocks, such as a file."""
    try:
        fd = lines.fileno()
    except (OSError, AttributeError, io.UnsupportedOperation):
        return None
    mode = os.fstat(fd).st_mode
    return fd if os.isatty(fd) or stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode) else None
