"""Robot programs that start quickly: forked from a process in which everything is imported already."""

import contextlib
import multiprocessing
import os
import signal
import sys
from multiprocessing.process import BaseProcess
from pathlib import Path

import anyio
import anyio.to_thread

_PRELOADED = ["tests.crash.preloaded"]
_LOOK_S = 0.005


def _run(words: tuple[str, ...], folder: Path, log: Path) -> None:
    """`kurt2rt ...` in this fresh process, as it runs in one of its own."""
    os.chdir(folder)
    output = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    for stream in (1, 2):
        os.dup2(output, stream)
    sys.argv = ["kurt2rt", *words]
    from kurt2rt.cli.main import main

    main()


class Program:
    """A `kurt2rt ...` that can be killed and stopped."""

    def __init__(self, process: BaseProcess, log: Path) -> None:
        self._process = process
        self._log = log

    @property
    def said(self) -> str:
        """All that it printed until now."""
        return self._log.read_text(encoding="utf-8") if self._log.exists() else ""

    @property
    def lives(self) -> bool:
        """Whether it still runs."""
        return self._process.is_alive()

    async def says(self, text: str) -> str:
        """Wait until it has printed a line with this text; the line."""
        while True:
            for line in self.said.splitlines(keepends=True):
                if text in line and line.endswith("\n"):
                    return line
            if not self.lives:
                raise AssertionError(f"{text!r} was never said:\n{self.said}")
            await anyio.sleep(_LOOK_S)  # a file tells nobody that it grows

    def signal(self, number: signal.Signals) -> None:
        """Send it a signal, if it is still there."""
        with contextlib.suppress(ProcessLookupError):
            assert self._process.pid is not None
            os.kill(self._process.pid, number)

    async def ended(self) -> int:
        """Wait for its end; its exit code, less than 0 for the signal that killed it."""
        await anyio.to_thread.run_sync(self._process.join)
        assert self._process.exitcode is not None
        return self._process.exitcode

    async def killed(self) -> None:
        """Kill it and wait for its end, while others go on."""
        self._process.kill()
        await self.ended()

    def kill(self) -> None:
        """Kill it and wait for its end."""
        self._process.kill()
        self._process.join()


class Nursery:
    """Where programs come from."""

    def __init__(self) -> None:
        self._context = multiprocessing.get_context("forkserver")
        self._context.set_forkserver_preload(_PRELOADED)
        self._programs: list[Program] = []

    def start(self, *words: str, folder: Path, log: Path) -> Program:
        """Start `kurt2rt ...` in a folder; what it prints goes to the end of the log."""
        process = self._context.Process(target=_run, args=(words, folder, log), daemon=True)
        process.start()
        program = Program(process, log)
        self._programs.append(program)
        return program

    def close(self) -> None:
        """Kill what is left."""
        for program in self._programs:
            program.kill()
