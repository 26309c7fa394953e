"""Status socket: another program of the machine reads the health report."""

import json
import socket
import threading
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import cast

import anyio
import anyio.to_thread
import pytest

from kurt2rt.channel.protocol.health import HEALTH, HealthReport
from kurt2rt.service.health.monitor import HealthMonitor
from kurt2rt.service.health.status_error import StatusCode, StatusError
from kurt2rt.service.health.status_socket import StatusSocket, read_reports, short_name, status_socket_path
from tests.patience import PATIENCE_S
from tests.service.health.reports import ILL, WELL


class Watch:
    """Says what the test says."""

    def __init__(self) -> None:
        self.newest: HealthReport | None = None
        self._listeners: list[object] = []

    def add_listener(self, listener: object) -> None:
        self._listeners.append(listener)

    def tell(self, report: HealthReport) -> None:
        self.newest = report
        for listener in self._listeners:
            listener(report)  # type: ignore[operator]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    folder = tmp_path / ("a folder with a name that is too long for the kernel's names of sockets " * 2)
    folder.mkdir()
    return status_socket_path(folder / "x.knowledge")


@asynccontextmanager
async def serving(watch: Watch, path: Path) -> AsyncIterator[StatusSocket]:
    status = StatusSocket(cast(HealthMonitor, watch), path)
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(status.serve)
        await until(lambda: is_told(path) or bool(status.trouble))
        yield status
        tasks.cancel_scope.cancel()


@contextmanager
def bound(path: Path) -> Iterator[socket.socket]:
    """Connect a program that listens and sends nothing by itself."""
    with socket.socket(socket.AF_UNIX) as listener, short_name(path) as short:
        listener.bind(short)
        listener.listen()
        yield listener


def is_told(path: Path) -> bool:
    """Return whether a program listens there."""
    with socket.socket(socket.AF_UNIX) as reader, short_name(path) as short:
        return reader.connect_ex(short) == 0


def mode_of(path: Path) -> int:
    """Its mode; 0 where there is nothing."""
    return path.stat().st_mode if path.exists() else 0


async def until(holds: Callable[[], bool]) -> None:
    with anyio.fail_after(PATIENCE_S):
        while not holds():  # noqa: ASYNC110 - a file does not notify
            await anyio.sleep(0.005)


async def following(reports: Iterator[HealthReport]) -> HealthReport:
    return await anyio.to_thread.run_sync(lambda: next(reports))


async def test_a_reader_gets_the_newest_report_at_once_and_then_each(path: Path) -> None:
    watch = Watch()
    watch.tell(WELL)
    async with serving(watch, path):
        reports = read_reports(path, PATIENCE_S)
        assert await following(reports) == WELL
        watch.tell(ILL)
        assert await following(reports) == ILL
        assert mode_of(path) & 0o077 == 0  # others than its user are told nothing
    with pytest.raises(StatusError) as ended:
        next(reports)
    assert ended.value.code is StatusCode.ENDED
    assert mode_of(path) == 0


async def test_in_its_first_second_a_reader_waits_for_the_report(path: Path) -> None:
    watch = Watch()
    async with serving(watch, path), anyio.create_task_group() as tasks:
        got: list[HealthReport] = []

        async def read() -> None:
            got.append(await following(read_reports(path, PATIENCE_S)))

        tasks.start_soon(read)
        await anyio.sleep(0.01)
        watch.tell(WELL)
    assert got == [WELL]


async def test_status_socket_of_a_killed_program_is_replaced(path: Path) -> None:
    with bound(path):
        pass
    assert mode_of(path)
    with pytest.raises(StatusError) as refused:
        next(read_reports(path, PATIENCE_S))
    assert refused.value.code is StatusCode.NO_PROGRAM
    watch = Watch()
    watch.tell(WELL)
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(StatusSocket(cast(HealthMonitor, watch), path).serve)
        await until(lambda: is_told(path))
        assert await following(read_reports(path, PATIENCE_S)) == WELL
        tasks.cancel_scope.cancel()


def test_one_that_says_nothing_hangs(path: Path) -> None:
    with bound(path), pytest.raises(StatusError) as hangs:
        next(read_reports(path, 0.05))
    assert hangs.value.code is StatusCode.SILENT


def test_another_version_is_not_guessed_at(path: Path) -> None:
    plain = HEALTH.plain_of(WELL)
    del plain["machine"]

    def answer() -> None:
        connection, _ = other.accept()
        with connection:
            connection.sendall(json.dumps(plain).encode() + b"\n")

    with bound(path) as other:
        answering = threading.Thread(target=answer)
        answering.start()
        with pytest.raises(StatusError, match="machine") as other_version:
            next(read_reports(path, PATIENCE_S))
        assert other_version.value.code is StatusCode.NOT_UNDERSTOOD
        answering.join()


async def test_status_socket_that_cannot_be_made_sets_the_error(tmp_path: Path) -> None:
    path = tmp_path / "taken.status"
    path.mkdir()
    async with serving(Watch(), path) as status:
        await until(lambda: bool(status.trouble))
    assert status.trouble.startswith(f"{path}: ")
