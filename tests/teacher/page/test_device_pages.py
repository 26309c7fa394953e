"""Pages of several devices on one port: access, links, and changes of the pairings."""

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import anyio
import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.channel.security.pairing import LOCAL, TERMINAL, Device, PairingFolders, local_pairing, pair, renew, revoke
from kurt2rt.teacher.page.device_pages import DevicePages, PageSite
from kurt2rt.teacher.page.device_server import local_devices, run_device_pages
from kurt2rt.teacher.page.served_pages import ServedPages
from tests.patience import eventually
from tests.teacher.page.fake_robot import FakeRobot
from tests.teacher.page.test_served_page import ask, hear

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
        await eventually(lambda: not self.open)

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

    async def tells(self, wanted: Callable[[ServedPages], bool]) -> None:
        await eventually(lambda: self.told and wanted(self.told[-1]))

    def link(self, device: str) -> str:
        (found,) = (each.link for each in self.told[-1].addresses if each.device == device)
        return found

    @property
    def port(self) -> int:
        return urlsplit(self.link(LOCAL)).port or 0

    async def pair(self, name: str) -> None:
        pair(self.pairings.teachers, self.pairings.devices, name)
        await self.tells(lambda served: served.network)


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


async def come_in(link: str, host: str = "127.0.0.1") -> dict[str, str]:
    """Open a link at a host; returns the headers that show its cookie."""
    parts = urlsplit(link)
    got = await ask(f"{host}:{parts.port}", f"{parts.path}?{parts.query}")
    assert got.status == 200
    return {"Cookie": got.headers["Set-Cookie"].split(";")[0], "Origin": f"http://{host}:{parts.port}"}


def websocket(headers: dict[str, str]) -> connect:
    at = urlsplit(headers["Origin"]).netloc
    return connect(f"ws://{at}/robot", additional_headers=headers, proxy=None)


async def test_paired_while_it_runs_opens_the_same_port_to_the_network(tmp_path: Path) -> None:
    async with server(tmp_path) as pages:
        port = pages.port
        assert pages.told[-1].network is False
        assert [each.device for each in pages.told[-1].addresses] == [LOCAL]
        with pytest.raises(ConnectionRefusedError):
            await ask(f"{ELSEWHERE}:{port}", "/")
        local = await come_in(pages.link(LOCAL))
        async with websocket(local) as socket:
            await hear(socket, "page")

            await pages.pair("phone")
            assert pages.port == port
            assert (await ask(f"{ELSEWHERE}:{port}", "/")).status == 403
            phone = await come_in(pages.link("phone"), ELSEWHERE)
            async with websocket(phone) as other:
                assert (await hear(other, "page"))["device"] == "phone"
            await socket.ping()  # who was there before the port changed still is

        revoke(pages.pairings.teachers, pages.pairings.devices, "phone")
        await pages.tells(lambda served: not served.network)
        with pytest.raises(ConnectionRefusedError):
            await ask(f"{ELSEWHERE}:{port}", "/")
        assert (await ask(f"127.0.0.1:{port}", "/", local)).status == 200


async def test_renewed_device_loses_its_connection_and_its_cookie(tmp_path: Path) -> None:
    async with server(tmp_path) as pages:
        await pages.pair("phone")
        before = pages.link("phone")
        phone = await come_in(before)
        async with websocket(phone) as socket:
            await hear(socket, "page")
            renew(pages.pairings.teachers, pages.pairings.devices, "phone")
            await socket.wait_closed()
        # Between two links the device may have none.
        await pages.tells(
            lambda served: any(each.device == "phone" and each.link != before for each in served.addresses)
        )
        with pytest.raises(InvalidStatus):
            await websocket(phone)
        async with websocket(await come_in(pages.link("phone"))) as socket:
            await hear(socket, "page")


async def test_a_page_without_browsers_opens_no_link_to_the_robot(tmp_path: Path) -> None:
    async with server(tmp_path) as pages:
        await pages.pair("phone")
        for path in ("/", "/robot", "/pair?token=guess"):
            assert (await ask(f"127.0.0.1:{pages.port}", path)).status == 403
        assert pages.links.opened == []
        await come_in(pages.link("phone"))
        assert list(pages.links.open) == ["phone"]


async def test_pairing_that_another_program_uses_is_said(tmp_path: Path) -> None:
    async with server(tmp_path) as pages:
        pages.links.taken.add(LOCAL)
        parts = urlsplit(pages.link(LOCAL))
        got = await ask(parts.netloc, f"{parts.path}?{parts.query}")
        assert got.status == 503
        assert got.body.startswith("local: ")
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


async def test_own_page_is_for_this_machine_and_lets_go_when_unused(tmp_path: Path) -> None:
    device, links = local_pairing(tmp_path / "teachers", tmp_path / "devices").device, Links()
    async with anyio.create_task_group() as tasks:
        pages = DevicePages(tasks, PageSite(links, "a robot", [], "desk", idle_s=0.01))
        pages.serve([device])
        assert await pair_at(pages, device, "192.168.0.7") == 403
        assert links.opened == []
        for times in (1, 2):
            assert await pair_at(pages, device, "127.0.0.1") == 200
            assert links.opened == [LOCAL] * times
            await links.closed()  # no browser shows the page
        await pages.end()


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
