"""Health report for other programs of this machine: a socket next to the knowledge file, one line a second."""

import json
import os
import socket
import threading
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import anyio
from anyio.abc import Listener, SocketStream

from kurt2rt.channel.protocol.health import HEALTH, HealthReport
from kurt2rt.core.message_fields import WireError
from kurt2rt.service.health.status_error import StatusCode, StatusError

if TYPE_CHECKING:
    from kurt2rt.service.health.monitor import HealthMonitor

_MOST_READERS = 8
_TAKEN_WITHIN_S = 2.0
_REMOVED_WITHIN_S = 0.2
_LONGEST_LINE = 65_536
_WAITS_FOR = "waits_for"
_PAGES = "pages"


def status_socket_path(knowledge: Path) -> Path:
    """Return the path of the status socket of the program that writes a knowledge file."""
    return knowledge.with_name(f"{knowledge.name}.status")


class StatusSocket:
    """Socket that sends every reader each report; disconnects a reader that does not read for 2 s."""

    def __init__(self, watch: "HealthMonitor", path: Path, pages: Callable[[], tuple[str, ...]] = tuple) -> None:
        """Listen for reports; `serve` opens the socket.

        Args:
            watch: monitor that makes the reports.
            path: path of the socket; users who may write it may read the status and the links.
            pages: returns the links to the teacher's page.
        """
        self._pages = pages
        self._watch = watch
        self._path = path
        self._news = anyio.Event()
        self._readers = 0
        self.trouble = ""
        """Reason why no program can read; empty if programs can."""
        watch.add_listener(self._wake)

    async def serve(self) -> None:
        """Serve readers until cancelled; if the socket cannot be made, set `trouble` and return."""
        try:
            async with _listener(self._path) as listener:
                await listener.serve(self._tell)
        except OSError as error:
            self.trouble = f"{self._path}: no status is served there ({error.strerror}); give a file in another folder"

    def _wake(self, _: HealthReport) -> None:
        self._news.set()
        self._news = anyio.Event()

    async def _tell(self, reader: SocketStream) -> None:
        if self._readers >= _MOST_READERS:
            await reader.aclose()
            return
        self._readers += 1
        try:
            async with reader:
                while True:
                    report, news = self._watch.newest, self._news
                    if report is not None:
                        with anyio.fail_after(_TAKEN_WITHIN_S):
                            await reader.send(
                                json.dumps({**HEALTH.plain_of(report), _PAGES: self._pages()}).encode() + b"\n"
                            )
                    await news.wait()
        except (anyio.BrokenResourceError, anyio.ClosedResourceError, TimeoutError):
            return  # gone or slow
        finally:
            self._readers -= 1


async def serve_waiting(path: Path, waits_for: Callable[[], str]) -> None:
    """Tell readers of the status socket why the program still waits, until cancelled.

    Each reader gets one line and is disconnected. Returns silently if the socket cannot be made. When the program has
    started, `StatusSocket.serve` replaces the socket at the same path.

    Args:
        path: path of the socket, as `status_socket_path` returns it.
        waits_for: called for each reader; returns what is missing and what to do, in a line.
    """

    async def tell(reader: SocketStream) -> None:
        async with reader:
            with suppress(anyio.BrokenResourceError, anyio.ClosedResourceError, TimeoutError):  # gone or slow
                with anyio.fail_after(_TAKEN_WITHIN_S):
                    await reader.send(json.dumps({_WAITS_FOR: waits_for()}).encode() + b"\n")

    with suppress(OSError):  # the status socket will say why it cannot be made
        with short_name(path) as short:
            listener = await anyio.create_unix_listener(short, mode=0o600)
        async with listener:
            await listener.serve(tell)


def read_reports(path: Path, patience_s: float) -> Iterator[HealthReport]:
    """Yield each report of the program that serves `path`, the newest first; blocks, so not for an event loop.

    Raises StatusError if no program runs, if it still waits for something, if no report comes for `patience_s`
    seconds, or if the program is of another version.
    """
    with socket.socket(socket.AF_UNIX) as reader, reader.makefile("rb") as lines:
        reader.settimeout(patience_s)
        try:
            with short_name(path) as short:
                reader.connect(short)
        except (FileNotFoundError, ConnectionRefusedError) as error:
            raise StatusError(StatusCode.NO_PROGRAM, knowledge=path.with_suffix("")) from error
        except OSError as error:
            raise StatusError(StatusCode.NOT_READ, where=path, error=error) from error
        while True:
            try:
                line = lines.readline(_LONGEST_LINE)
            except TimeoutError as error:
                raise StatusError(StatusCode.SILENT, where=path, silent_s=patience_s) from error
            except OSError as error:
                raise StatusError(StatusCode.BROKEN_OFF, where=path, error=error) from error
            if not line:
                raise StatusError(StatusCode.ENDED, where=path)
            try:
                told = json.loads(line)
                if isinstance(told, dict) and _WAITS_FOR in told:
                    raise StatusError(StatusCode.WAITS, missing=told[_WAITS_FOR])
                yield replace(HEALTH.read(told), pages=_links_in(told))
            except (ValueError, WireError) as error:
                raise StatusError(StatusCode.NOT_UNDERSTOOD, where=path, error=error) from error


def _links_in(told: Mapping[str, object]) -> tuple[str, ...]:
    links = told.get(_PAGES, ())
    return tuple(map(str, links)) if isinstance(links, list) else ()


@asynccontextmanager
async def _listener(path: Path) -> "AsyncIterator[Listener[SocketStream]]":
    with short_name(path) as short:
        # Replaces the socket of a killed program: this program alone writes the knowledge file.
        listener = await anyio.create_unix_listener(short, mode=0o600)
    try:
        async with listener:
            yield listener
    finally:
        # A disk that hangs must not delay the end of the program.
        removing = threading.Thread(target=_remove, args=(path,), name="end of status", daemon=True)
        removing.start()
        removing.join(_REMOVED_WITHIN_S)


def _remove(path: Path) -> None:
    # The next program replaces a socket that stays on a read-only disk.
    with suppress(OSError):
        path.unlink(missing_ok=True)


@contextmanager
def short_name(path: Path) -> Iterator[str]:
    """Yield a short name of the file, valid in the block: names of sockets have 107 bytes at most. Raises OSError."""
    folder = os.open(path.parent, os.O_PATH | os.O_DIRECTORY)
    try:
        yield f"/proc/self/fd/{folder}/{path.name}"
    finally:
        os.close(folder)
