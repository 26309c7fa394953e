"""Robot programs that start quickly, and can be killed and stopped."""

import os
import signal
from pathlib import Path
from types import TracebackType
from typing import Self

import anyio
import anyio.to_thread

from tests.forked_program import ForkedProcess

_LOOK_S = 0.005


class Program:
    """A `kurt2rt ...` forked by the session's fork server; as a context manager it is killed at the end."""

    def __init__(self, *words: str, folder: Path, log: Path) -> None:
        """Start it in a folder; what it prints goes to the end of the log."""
        self._log = log
        with Path(os.devnull).open("rb") as silence, log.open("ab") as output:
            streams = silence.fileno(), output.fileno(), output.fileno()
            self._process = ForkedProcess("kurt2rt.cli.main", words, folder, os.environ, streams)

    @property
    def said(self) -> str:
        """All that it printed until now."""
        return self._log.read_text(encoding="utf-8")

    @property
    def lives(self) -> bool:
        """Return whether the program still runs."""
        return self._process.poll() is None

    async def says(self, text: str) -> str:
        """Wait until it has printed a line with this text; the line."""
        while True:
            for line in self.said.splitlines(keepends=True):
                if text in line and line.endswith("\n"):
                    return line
            if not self.lives:
                raise AssertionError(f"{text!r} was never said:\n{self.said}")
            await anyio.sleep(_LOOK_S)  # a growing file sends no event

    def signal(self, number: signal.Signals) -> None:
        """Send it a signal, if it is still there."""
        self._process.send_signal(number)

    async def killed(self) -> None:
        """Kill it and wait for its end, while others go on."""
        self._process.kill()
        await anyio.to_thread.run_sync(self._process.wait)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.kill()
        self._process.wait()
