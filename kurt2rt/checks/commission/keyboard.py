"""Lines that a person types, one at a time, without holding up the loop."""

import io
import os
import stat
import termios
from typing import TextIO

import anyio

_CHUNK = 4096


class Keyboard:
    """Reads a line when it is asked for one. What was typed at a terminal before that is thrown away: a key that was
    hit too early must not turn wheels.
    """

    def __init__(self, lines: TextIO) -> None:
        self._lines = lines
        self._fd = _descriptor(lines)
        self._waiting = b""

    @property
    def echoes(self) -> bool:
        """True when the terminal itself shows what is typed."""
        return self._fd is not None and os.isatty(self._fd)

    async def line(self) -> str | None:
        """The next line without its end; None after the last. A pipe keeps its lines for their questions."""
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
    """Of a terminal, a pipe or a socket; None for what can be read without ever waiting, such as a file."""
    try:
        fd = lines.fileno()
    except (OSError, AttributeError, io.UnsupportedOperation):
        return None
    mode = os.fstat(fd).st_mode
    return fd if os.isatty(fd) or stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode) else None
