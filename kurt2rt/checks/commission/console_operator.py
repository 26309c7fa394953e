"""Operator at a terminal."""

import io
import os
import stat
import termios
from collections.abc import Sequence
from typing import TextIO

import anyio
from rich.console import Console
from rich.text import Text

from kurt2rt.checks.commission.operator import LEAVE, AbortedError, AnswerChoice, OperatorQuestion, Tone

_STYLES = {Tone.TITLE: "bold", Tone.GOOD: "green", Tone.TO_DO: "yellow", Tone.BAD: "bold red"}
_MARKS = {
    Tone.TITLE: "\n",
    Tone.PLAIN: "  ",
    Tone.MEASURED: "    ",
    Tone.GOOD: "  ",
    Tone.TO_DO: "  TO DO: ",
    Tone.BAD: "  ! ",
}
"""Prefixes that distinguish lines without colours."""


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


class ConsoleOperator:
    """Operator of the commissioning at a terminal: prints lines and questions, reads typed answers."""

    def __init__(self, lines: TextIO, console: Console) -> None:
        self._keyboard = Keyboard(lines)
        self._console = console

    def tell(self, text: str, tone: Tone = Tone.PLAIN) -> None:
        """Print a line, in the colour of its tone."""
        self._line(_MARKS[tone] + text, _STYLES.get(tone, ""))

    async def answer(self, question: OperatorQuestion) -> str:
        """Repeat the question until one of its answers is typed. Raises AbortedError at the end of input."""
        choices = (*question.choices, AnswerChoice(LEAVE, "leave"))
        while True:
            self._line(f"  {question.text}", "cyan")
            self._line(f"    {_shown(choices)} > ", end="")
            line = await self._keyboard.line()
            if line is None:
                self._console.print()
                raise AbortedError
            answer = line.strip().lower()
            if not self._keyboard.echoes:
                self.tell(answer)
            if question.free or answer in [choice.key for choice in choices]:
                return answer
            self.tell(f"{answer!r} is not an answer here.", Tone.BAD)

    def _line(self, text: str, style: str = "", end: str = "\n") -> None:
        # A terminal is wide as it is, and words stay whole; in a file a line is a line.
        self._console.print(Text(text, style=style), end=end, soft_wrap=not self._console.is_terminal)


def _shown(choices: Sequence[AnswerChoice]) -> str:
    return "  ".join(f"[{choice.key or 'Enter'}] {choice.meaning}" for choice in choices)
