"""Programs forked by the session's fork_server: with the words of subprocess.Popen, as far as stories need them."""

import json
import os
import select
import signal
import socket
import subprocess
import sys
import uuid
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import IO, Self

from tests.fork_server import ADDRESS, NUMBER

_ROOT = Path(__file__).parents[1]


def has_fork_server() -> bool:
    """Return whether this session has a fork server."""
    return ADDRESS in os.environ


@contextmanager
def fork_server() -> Iterator[None]:
    """Run a fork server for this session and its workers."""
    address = f"kurt2rt-fork_server-{uuid.uuid4().hex}"
    theirs, ours = os.pipe()
    with subprocess.Popen(
        [sys.executable, "-m", "tests.fork_server", address, str(theirs)],
        cwd=_ROOT,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        pass_fds=[theirs],
    ) as process:
        assert process.stdout is not None
        process.stdout.read(1)  # it listens
        os.close(theirs)
        os.environ[ADDRESS] = address
        try:
            yield
        finally:
            del os.environ[ADDRESS]
            os.close(ours)


class ForkedProcess:
    """Forked program that runs like `python -m MODULE WORDS`."""

    def __init__(
        self,
        module: str,
        words: Sequence[str],
        folder: Path,
        environment: Mapping[str, str],
        streams: tuple[int, int, int],
    ) -> None:
        """`streams`: the descriptors of its standard input, output and errors, which stay open here.

        Raises KeyError where there is no fork_server, and OSError where it has gone.
        """
        self.returncode: int | None = None
        self._told, tells = os.pipe()
        try:
            with socket.socket(socket.AF_UNIX) as caller:
                caller.connect(f"\0{os.environ[ADDRESS]}")
                order = json.dumps([module, list(words), str(folder), dict(environment)]).encode()
                sent = socket.send_fds(caller, [order], [*streams, tells])
                caller.sendall(order[sent:])
                caller.shutdown(socket.SHUT_WR)
        finally:
            os.close(tells)
        self.pid = self._number()

    def _number(self) -> int:
        data = os.read(self._told, NUMBER.size)
        if len(data) != NUMBER.size:
            raise OSError("the fork_server of this session has gone, or cannot import what it should")
        (number,) = NUMBER.unpack(data)
        return int(number)

    def wait(self, timeout: float | None = None) -> int:
        """Wait for its end; its exit code, less than 0 for the signal that killed it."""
        if self.returncode is None:
            if not select.select([self._told], [], [], timeout)[0]:
                raise subprocess.TimeoutExpired(str(self.pid), timeout or 0.0)
            self.returncode = self._number()
            os.close(self._told)
        return self.returncode

    def poll(self) -> int | None:
        """Its exit code, if it has ended."""
        if self.returncode is None and select.select([self._told], [], [], 0.0)[0]:
            self.wait()
        return self.returncode

    def send_signal(self, number: signal.Signals) -> None:
        """Send it a signal, if it is still there."""
        if self.poll() is None:
            with suppress(ProcessLookupError):  # it may have ended meanwhile
                os.kill(self.pid, number)

    def terminate(self) -> None:
        """Ask it to end."""
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        """Kill it."""
        self.send_signal(signal.SIGKILL)


class ForkedProgram(ForkedProcess):
    """One with pipes to its keyboard and from its outputs."""

    def __init__(self, module: str, words: Sequence[str], folder: Path, environment: Mapping[str, str]) -> None:
        """Start the program; raise the errors of ForkedProcess."""
        keyboard, stdin = os.pipe()
        stdout, printed = os.pipe()
        stderr, complained = os.pipe()
        self.stdin: IO[str] = os.fdopen(stdin, "w", encoding="utf-8")
        self.stdout: IO[str] = os.fdopen(stdout, encoding="utf-8")
        self.stderr: IO[str] = os.fdopen(stderr, encoding="utf-8")
        theirs = keyboard, printed, complained
        try:
            super().__init__(module, words, folder, environment, theirs)
        finally:
            for each in theirs:
                os.close(each)

    def communicate(self) -> tuple[str, str]:
        """All that it still says until it has ended, on both outputs."""
        self.stdin.close()
        with ThreadPoolExecutor(1) as aside:
            complaints = aside.submit(self.stderr.read)
            said = self.stdout.read()
        self.wait()
        return said, complaints.result()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for each in (self.stdin, self.stdout, self.stderr):
            try:
                each.close()
            except BrokenPipeError:  # what was typed last it did not read any more
                continue
        self.wait()
