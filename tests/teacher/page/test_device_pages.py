"""Pages of several devices on one port: access, links, and changes of the pairings."""

import http.client
import json
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import anyio
import anyio.to_thread
import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidStatus

from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.channel.security.pairing import LOCAL, TERMINAL, Device, PairingFolders, local_pairing, pair, renew, revoke
from kurt2rt.teacher.page.device_pages import DevicePages, PageSite
from kurt2rt.teacher.page.device_server import local_devices, run_device_pages
from kurt2rt.teacher.page.served_pages import ServedPages
from tests.patience import PATIENCE_S
from tests.teacher.page.fake_robot import FakeRobot

ELSEWHERE = "127.0.0.2"
"""Address of this machine that a port on 127.0.0.1 alone does not serve."""


@dataclass
class Links:
    """Links to robots, one at a time for each device."""

    open: dict[str, FakeRobot] = field(default_factory=dict)
    opened: list[str] = field(default_factory=list)
    taken: set[str] = field(default_factory=set)
    """Devices whose pairing another program uses."""

    async def closed(self) -> None:
        with anyio.fail_after(PATIENCE_S):
            while True:
                if not self.open:
                    return
                await anyio.sleep(0.01)

    @asynccontextmanager
    async def __call__(self, device: Device) -> AsyncIterator[FakeRobot]:
        assert device.name not in self.open
        if device.name in self.taken:
            raise CredentialsError(f"{device.name}: another program uses this pairing")
        self.opened.append(device.name)
        self.open[device.name] = robot = FakeRobot()
        try:
            yield robot
        finally:
            del self.open[device.name]


@dataclass
class Server:
    pairings: PairingFolders
    links: Links
    told: list[ServedPages]

    async def tells(self, wanted: Callable[[ServedPages], bool]) -> ServedPages:
        with anyio.fail_after(PATIENCE_S):
            while True:
                if self.told and wanted(self.told[-1]):
                    return self.told[-1]
                await anyio.sleep(0.01)

    def link(self, device: str) -> str:
        (found,) = (each.link for each in self.told[-1].addresses if each.device == device)
        return found

    @property
    def port(self) -> int:
        return urlsplit(self.link(LOCAL)).port or 0

    def pair(self, name: str) -> None:
        pair(self.pairings.teachers, self.pairings.devices, name)


@asynccontextmanager
async def server(folder: Path) -> AsyncIterator[Server]:
    pairings, links, end = PairingFolders(folder / "teachers", folder / "devices"), Links(), anyio.Event()
    told: list[ServedPages] = []
    serve = partial(run_device_pages, poll_s=0.02)
    local_pairing(pairings.teachers, pairings.devices)
    local_pairing(pairings.teachers, pairings.devices, TERMINAL)
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(
            serve,
            partial(local_devices, pairings),
            PageSite(links, "a robot", ["desk"], "desk"),
            0,
            told.append,
            end.wait,
        )
        opened = Server(pairings, links, told)
        await opened.tells(lambda _: True)
        yield opened
        end.set()


async def get(address: str, path: str, headers: dict[str, str] | None = None) -> tuple[int, str, str]:
    """Status, body and cookie of what is at `address`, a host and a port."""

    def ask() -> tuple[int, str, str]:
        connection = http.client.HTTPConnection(address, timeout=PATIENCE_S)
        try:
            connection.request("GET", path, headers=headers or {})
            response = connection.getresponse()
            return response.status, response.read().decode(), str(response.headers["Set-Cookie"]).split(";")[0]
        finally:
            connection.close()

    return await anyio.to_thread.run_sync(ask)


async def come_in(link: str, host: str = "127.0.0.1") -> dict[str, str]:
    """Open a link at a host; returns the headers that show its cookie."""
    parts = urlsplit(link)
    status, _, cookie = await get(f"{host}:{parts.port}", f"{parts.path}?{parts.query}")
    assert status == 200
    return {"Cookie": cookie, "Origin": f"http://{host}:{parts.port}"}


def websocket(headers: dict[str, str]) -> connect:
    at = urlsplit(headers["Origin"]).netloc
    return connect(f"ws://{at}/robot", additional_headers=headers, proxy=None)


async def greeting(socket: ClientConnection) -> dict[str, Any]:
    while True:
        message: dict[str, Any] = json.loads(await socket.recv())
        if message["kind"] == "page":
            return message


async def to_the_end(socket: ClientConnection) -> None:
    while True:
        await socket.recv()


async def test_paired_while_it_runs_opens_the_same_port_to_the_network(tmp_path: Path) -> None:
    async with server(tmp_path) as pages:
        port = pages.port
        assert pages.told[-1].network is False
        assert [each.device for each in pages.told[-1].addresses] == [LOCAL]
        with pytest.raises(ConnectionRefusedError):
            await get(f"{ELSEWHERE}:{port}", "/")
        local = await come_in(pages.link(LOCAL))
        async with websocket(local) as socket:
            await greeting(socket)

            pages.pair("phone")
            await pages.tells(lambda served: served.network)
            assert pages.port == port
            assert (await get(f"{ELSEWHERE}:{port}", "/"))[0] == 403
            phone = await come_in(pages.link("phone"), ELSEWHERE)
            async with websocket(phone) as other:
                assert (await greeting(other))["device"] == "phone"
            await socket.ping()  # who was there before the port changed still is

        revoke(pages.pairings.teachers, pages.pairings.devices, "phone")
        await pages.tells(lambda served: not served.network)
        with pytest.raises(ConnectionRefusedError):
            await get(f"{ELSEWHERE}:{port}", "/")
        assert (await get(f"127.0.0.1:{port}", "/", local))[0] == 200


async def test_renewed_device_loses_its_connection_and_its_cookie(tmp_path: Path) -> None:
    async with server(tmp_path) as pages:
        pages.pair("phone")
        await pages.tells(lambda served: served.network)
        before = pages.link("phone")
        phone = await come_in(before)
        async with websocket(phone) as socket:
            await greeting(socket)
            renew(pages.pairings.teachers, pages.pairings.devices, "phone")
            with pytest.raises(ConnectionClosed):
                await to_the_end(socket)
        # Between two links the device may have none.
        await pages.tells(
            lambda served: any(each.device == "phone" and each.link != before for each in served.addresses)
        )
        with pytest.raises(InvalidStatus):
            async with websocket(phone):
                pass
        async with websocket(await come_in(pages.link("phone"))) as socket:
            await greeting(socket)


async def test_a_page_without_browsers_opens_no_link_to_the_robot(tmp_path: Path) -> None:
    async with server(tmp_path) as pages:
        pages.pair("phone")
        await pages.tells(lambda served: served.network)
        for path in ("/", "/robot", "/pair?token=guess"):
            assert (await get(f"127.0.0.1:{pages.port}", path))[0] == 403
        assert pages.links.opened == []
        await come_in(pages.link("phone"))
        assert list(pages.links.open) == ["phone"]


async def test_pairing_that_another_program_uses_is_said(tmp_path: Path) -> None:
    async with server(tmp_path) as pages:
        pages.links.taken.add(LOCAL)
        parts = urlsplit(pages.link(LOCAL))
        status, body, _ = await get(parts.netloc, f"{parts.path}?{parts.query}")
        assert status == 503
        assert body.startswith("local: ")
        pages.links.taken.clear()
        await come_in(pages.link(LOCAL))


async def pair_at(pages: DevicePages, device: Device, host: str) -> int:
    """Ask for the link of a device at an address of this machine; return the status."""
    answers: list[dict[str, Any]] = []

    async def answer(message: Any) -> None:
        answers.append(message)

    async def ask() -> dict[str, Any]:
        return {"type": "http.request", "body": b""}

    scope = {"type": "http", "method": "GET", "path": "/pair", "query_string": f"token={device.token}".encode()}
    here = {"headers": [(b"host", host.encode())], "server": (host, 8642), "client": (host, 50000)}
    await pages({**scope, **here}, ask, answer)
    return int(answers[0]["status"])


@asynccontextmanager
async def pages_of(device: Device, links: Links, idle_s: float) -> AsyncIterator[DevicePages]:
    async with anyio.create_task_group() as tasks:
        pages = DevicePages(tasks, PageSite(links, "a robot", [], "desk", idle_s=idle_s))
        pages.serve([device])
        yield pages
        await pages.end()


async def test_page_that_nobody_shows_for_long_lets_go_of_its_pairing(tmp_path: Path) -> None:
    device, links = local_pairing(tmp_path / "teachers", tmp_path / "devices").device, Links()
    async with pages_of(device, links, 0.01) as pages:
        for times in (1, 2):
            assert await pair_at(pages, device, "127.0.0.1") == 200
            assert links.opened == [LOCAL] * times
            await links.closed()


async def test_this_machines_own_page_is_not_served_to_the_network(tmp_path: Path) -> None:
    device, links = local_pairing(tmp_path / "teachers", tmp_path / "devices").device, Links()
    async with pages_of(device, links, 60.0) as pages:
        assert await pair_at(pages, device, "192.168.0.7") == 403
    assert links.opened == []


def test_local_devices_lists_own_then_newest_present_ones(tmp_path: Path) -> None:
    pairings = PairingFolders(tmp_path / "teachers", tmp_path / "devices")
    for name in (LOCAL, TERMINAL):
        local_pairing(pairings.teachers, pairings.devices, name)
    for name in ("old-phone", "tablet", "phone", "broken"):
        pair(pairings.teachers, pairings.devices, name)
    (pairings.devices / "tablet").rename(tmp_path / "moved")
    (pairings.devices / "broken" / "device.json").write_text("{", encoding="utf-8")
    found, trouble = local_devices(pairings)
    assert [each.name for each in found] == [LOCAL, "phone", "old-phone"]
    assert "kurt2rt pair broken --renew" in trouble
