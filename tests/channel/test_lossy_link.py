"""The bad link does what it says, the same each time."""

import asyncio
from collections.abc import AsyncIterator
from typing import cast

import pytest

from tests.channel.lossy_link import LossyLink, Weather
from tests.patience import PATIENCE_S


class Mailbox(asyncio.DatagramProtocol):
    """Keeps what arrives, and answers each with the same in capitals where it is an echo."""

    def __init__(self, *, echo: bool) -> None:
        self.arrived: list[bytes] = []
        self.news = asyncio.Event()
        self._echo = echo
        self.transport: asyncio.DatagramTransport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport = cast(asyncio.DatagramTransport, transport)

    def datagram_received(self, data: bytes, addr: tuple[str, int]) -> None:
        self.arrived.append(data)
        self.news.set()
        if self._echo:
            assert self.transport is not None
            self.transport.sendto(data.upper(), addr)

    def send(self, *datagrams: bytes) -> None:
        assert self.transport is not None
        for each in datagrams:
            self.transport.sendto(each)

    async def until(self, count: int) -> list[bytes]:
        async with asyncio.timeout(PATIENCE_S):
            while len(self.arrived) < count:
                self.news.clear()
                await self.news.wait()
        return self.arrived

    @property
    def port(self) -> int:
        assert self.transport is not None
        port: int = self.transport.get_extra_info("sockname")[1]
        return port


@pytest.fixture
async def robot() -> AsyncIterator[Mailbox]:
    loop = asyncio.get_running_loop()
    transport, mailbox = await loop.create_datagram_endpoint(lambda: Mailbox(echo=True), local_addr=("127.0.0.1", 0))
    yield mailbox
    transport.close()


async def client_of(link: LossyLink) -> Mailbox:
    _, mailbox = await asyncio.get_running_loop().create_datagram_endpoint(
        lambda: Mailbox(echo=False), remote_addr=("127.0.0.1", link.port)
    )
    return mailbox


def close(mailbox: Mailbox) -> None:
    assert mailbox.transport is not None
    mailbox.transport.close()


async def fates(robot: Mailbox, weather: Weather, seed: int) -> list[bytes]:
    async with LossyLink(robot.port, down=weather, seed=seed) as link:
        client = await client_of(link)
        for number in range(100):
            client.send(b"%d" % number)
            await link.until(lambda: link.down.came == number + 1)  # noqa: B023 - called only in this round
        link.change_weather(down=Weather())
        client.send(b"end")
        async with asyncio.timeout(PATIENCE_S):
            while b"END" not in client.arrived:
                client.news.clear()
                await client.news.wait()
        close(client)
        return client.arrived


async def test_the_same_seed_loses_the_same_ones(robot: Mailbox) -> None:
    first = await fates(robot, Weather(loss=0.3), seed=1)
    assert 55 < len(first) < 85
    assert await fates(robot, Weather(loss=0.3), seed=1) == first
    assert await fates(robot, Weather(loss=0.3), seed=2) != first


async def test_a_cut_link_is_a_black_hole_until_it_is_mended(robot: Mailbox) -> None:
    async with LossyLink(robot.port) as link:
        client = await client_of(link)
        link.cut()
        client.send(b"lost")
        await link.until(lambda: link.up.lost == 1)
        link.mend()
        client.send(b"found")
        assert await client.until(1) == [b"FOUND"]
        assert robot.arrived == [b"found"]
        close(client)
