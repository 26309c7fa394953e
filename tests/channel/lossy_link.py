"""A bad radio link on loopback: datagrams are lost, late, doubled, out of order, held back, or all of them gone."""

import asyncio
import random
import socket
from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType
from typing import Self

from tests.patience import PATIENCE_S

_LARGEST_DATAGRAM = 65_536


@dataclass(frozen=True, slots=True)
class Weather:
    """Faults of one direction; fractions are probabilities per datagram."""

    loss: float = 0.0
    delay_s: float = 0.0
    jitter_s: float = 0.0
    """Further delay, drawn evenly from none to this; it reorders what is close together."""
    doubled: float = 0.0
    """Share that comes a second time, with a delay of its own."""
    overtaken: float = 0.0
    """Share that is late by `overtaken_s`, so that the next ones come first."""
    overtaken_s: float = 0.03
    held_back: float = 0.0
    """Share that is kept for `held_back_s` and then delivered, as an attacker would."""
    held_back_s: float = 5.0


@dataclass(slots=True)
class Way:
    """One direction."""

    weather: Weather
    """Weather for what comes from now on; a test may change it."""
    chance: random.Random
    lost: int = 0
    """Datagrams lost by the weather, or while the link was cut."""


class LossyLink:
    """A UDP proxy in the running event loop: talk to `port` of 127.0.0.1 instead of the robot's.

    Each client gets a socket of its own towards the robot, so the robot tells them apart. The same seed draws the same
    fates in the same order for each direction.
    """

    def __init__(
        self, robot_port: int, *, up: Weather | None = None, down: Weather | None = None, seed: int = 0
    ) -> None:
        """`up` is the weather on the way to the robot on 127.0.0.1:`robot_port`, `down` that on the way back."""
        self._robot = ("127.0.0.1", robot_port)
        self.up = Way(up or Weather(), random.Random(f"{seed} up"))
        self.down = Way(down or Weather(), random.Random(f"{seed} down"))
        self._cut = False
        self._front: socket.socket | None = None
        self._behind: dict[tuple[str, int], socket.socket] = {}
        self._late: set[asyncio.TimerHandle] = set()
        self._news = asyncio.Event()

    async def __aenter__(self) -> Self:
        front = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        front.setblocking(False)
        front.bind(("127.0.0.1", 0))
        self._front = front
        asyncio.get_running_loop().add_reader(front, self._from_clients)
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        assert self._front is not None
        for late in self._late:
            late.cancel()
        for each in (self._front, *self._behind.values()):
            asyncio.get_running_loop().remove_reader(each)
            each.close()

    @property
    def port(self) -> int:
        """UDP port for the clients."""
        assert self._front is not None
        port: int = self._front.getsockname()[1]
        return port

    def cut(self) -> None:
        """Drop all datagrams, also those under way, without an error to the sender."""
        self._cut = True

    def mend(self) -> None:
        """Datagrams pass again."""
        self._cut = False

    async def until(self, holds: Callable[[], bool]) -> None:
        """Wait until something holds that changes with the traffic."""
        async with asyncio.timeout(PATIENCE_S):
            while not holds():
                self._news.clear()
                await self._news.wait()

    def _from_clients(self) -> None:
        assert self._front is not None
        datagram, client = self._front.recvfrom(_LARGEST_DATAGRAM)
        behind = self._behind.get(client)
        if behind is None:
            behind = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            behind.setblocking(False)
            behind.connect(self._robot)
            self._behind[client] = behind
            asyncio.get_running_loop().add_reader(behind, self._from_robot, behind, client)
        self._pass_on(self.up, behind, datagram, None)

    def _from_robot(self, behind: socket.socket, client: tuple[str, int]) -> None:
        assert self._front is not None
        try:
            datagram = behind.recv(_LARGEST_DATAGRAM)
        except ConnectionRefusedError:
            return  # no robot there: over a radio the sender gets no error either
        self._pass_on(self.down, self._front, datagram, client)

    def _pass_on(self, way: Way, out: socket.socket, datagram: bytes, to: tuple[str, int] | None) -> None:
        weather, chance = way.weather, way.chance
        # All is drawn for each datagram, whatever its fate: one that is lost does not change those of the next ones.
        lost, doubled, overtaken, held_back = (chance.random() for _ in range(4))
        delays = [weather.delay_s + weather.jitter_s * chance.random() for _ in range(2)]
        self._news.set()
        if self._cut or lost < weather.loss:
            way.lost += 1
            return
        if held_back < weather.held_back:
            delays[0] += weather.held_back_s
        elif overtaken < weather.overtaken:
            delays[0] += weather.overtaken_s
        for delay_s in delays if doubled < weather.doubled else delays[:1]:
            if delay_s > 0.0:
                self._deliver_later(delay_s, way, out, datagram, to)
            else:
                self._deliver(way, out, datagram, to)

    def _deliver_later(
        self, delay_s: float, way: Way, out: socket.socket, datagram: bytes, to: tuple[str, int] | None
    ) -> None:
        def deliver() -> None:
            self._late.discard(handle)
            self._deliver(way, out, datagram, to)

        handle = asyncio.get_running_loop().call_later(delay_s, deliver)
        self._late.add(handle)

    def _deliver(self, way: Way, out: socket.socket, datagram: bytes, to: tuple[str, int] | None) -> None:
        self._news.set()
        if self._cut:
            way.lost += 1
            return
        try:
            if to is None:
                out.send(datagram)
            else:
                out.sendto(datagram, to)
        except (BlockingIOError, ConnectionRefusedError):
            way.lost += 1  # a full buffer, or a closed port: lost like any other
