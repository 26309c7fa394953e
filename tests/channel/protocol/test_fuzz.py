"""Hostile datagrams by the hundred thousand: nothing breaks, nothing counts, and the robot goes on ticking."""

import asyncio
import gc
import socket
import struct
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import aiocoap
import pytest

from kurt2rt.channel.protocol.codec import encode_request
from kurt2rt.channel.protocol.requests import HelloRequest, LessonsRequest, StopRequest
from kurt2rt.channel.security.oscore_context import OscoreContext
from kurt2rt.channel.server.datagram_filter import LONGEST_DATAGRAM, SocketAddress
from kurt2rt.core.decision.standing import ActiveStop
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.teaching.commands import Drive, HoldAction, Resume, Take, Teach
from kurt2rt.teacher import TeacherClient
from tests.channel.hostile_datagrams import HostileDatagrams
from tests.channel.jumping_loop import run_jumping
from tests.channel.robot_at_work import PERIOD_S, RobotAtWork, journal_of, robot_at_work
from tests.channel.sides import answer_challenge, header_of

# An error of aiocoap: a request repeated under the same token before it was handled.
pytestmark = pytest.mark.filterwarnings("ignore:coroutine 'Context._render_to_pipe' was never awaited:RuntimeWarning")

_NOWHERE: SocketAddress = ("::ffff:127.0.0.2", 9, 0, 0)
"""A forged sender: what is answered to it comes back as an error of the network."""
_TO_LOOPBACK = [
    (
        socket.IPPROTO_IPV6,
        socket.IPV6_PKTINFO,
        socket.inet_pton(socket.AF_INET6, "::ffff:127.0.0.1") + struct.pack("I", socket.if_nametoindex("lo")),
    )
]
"""Ancillary data of a datagram: its destination address."""
_SETTLED_S = 1.0
_PER_TICK = 200


class _AllMayPass:
    """Bucket that lets all strangers in."""

    def acquire(self) -> bool:
        return True


@dataclass(frozen=True)
class Effects:
    """All that a command could have changed."""

    teacher: str | None
    phase: int
    stopped: ActiveStop | None
    session: str | None
    rlas: int
    lessons: int
    corrections: int
    waiting: int


def effects(at_work: RobotAtWork) -> Effects:
    school, system = at_work.runtime.handler, at_work.runtime.level.system
    return Effects(
        school.authority.teacher,
        school.phase,
        school.stops.active,
        school.clock.session,
        len(system),
        system.history.standing,
        school.corrections_at[BASIC],
        len(at_work.runtime.inbox.pop_all()),
    )


class Target:
    """The robot under fire, from the inside of its socket and from the outside."""

    def __init__(self, at_work: RobotAtWork, device: OscoreContext, seed: int) -> None:
        self.at_work = at_work
        self.device = device
        handler: Any = at_work.channel.handler
        self.hostile = HostileDatagrams(seed, lambda: (handler._parts.boot, handler.tick))
        self.errors: list[str] = []
        self._endpoint: Any = at_work.channel.endpoint
        keys: Any = at_work.channel.site._keys
        answer_challenge(device, keys.find(header_of(device)))
        (tokens,) = self._endpoint._context.request_interfaces
        self._socket = tokens.token_interface.message_interface
        self._outside = _outside()
        self.sender: SocketAddress = ("::ffff:127.0.0.1", self._outside.getsockname()[1], 0, 0)
        """Of what the device sends: known to hold a key."""
        self._stranger = _outside()
        self.stranger: SocketAddress = ("::ffff:127.0.0.1", self._stranger.getsockname()[1], 0, 0)
        asyncio.get_running_loop().set_exception_handler(self._on_error)

    def _on_error(self, _: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        self.errors.append(f"{context['message']}: {context.get('exception')!r}")

    def close(self) -> None:
        self._outside.close()
        self._stranger.close()
        self.device.close()

    def feed(self, datagram: bytes, sender: SocketAddress) -> None:
        """Hand a datagram over like the kernel."""
        self._socket.datagram_msg_received(datagram, _TO_LOOPBACK, 0, sender)

    def send(self, datagram: bytes, *, stranger: bool) -> None:
        """Send a datagram through the kernel."""
        (self._stranger if stranger else self._outside).sendto(datagram, ("127.0.0.1", self.at_work.port))

    def answers(self) -> tuple[int, int]:
        """Return the number of datagrams to the device and to strangers since the last call."""
        return _drained(self._outside), _drained(self._stranger)

    @contextmanager
    def strangers_without_limit(self) -> Iterator[None]:
        gate = self._endpoint._filter
        limited, gate._strangers = gate._strangers, _AllMayPass()
        try:
            yield
        finally:
            gate._strangers = limited

    async def capture(self) -> list[bytes]:
        """Return the datagrams of a teacher who took the robot, taught, drove, stopped and resumed."""
        captured = []
        kinds = (HelloRequest, Take, Teach, HoldAction, Drive, StopRequest, Resume, LessonsRequest)
        for kind in kinds:
            request = aiocoap.Message(code=aiocoap.POST, payload=encode_request(self.hostile.valid(kind.path)))
            request.opt.uri_path = tuple(kind.path.strip("/").split("/"))
            captured.append(self.hostile.protected(self.device, request))
            self.feed(captured[-1], self.sender)
            await asyncio.sleep(2 * PERIOD_S)
        await asyncio.sleep(_SETTLED_S)
        return captured

    def must_be_unmoved(self, before: Effects, tick: int) -> None:
        assert not self.at_work.ended
        assert self.errors == []
        assert self.at_work.channel.failures == 0
        assert self._endpoint.counters.failed == 0, self._endpoint.newest_failure
        assert self.at_work.moved_since(tick) == []
        assert effects(self.at_work) == before


def _outside() -> socket.socket:
    outside = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    outside.setblocking(False)
    outside.bind(("127.0.0.1", 0))
    return outside


def _drained(outside: socket.socket) -> int:
    count = 0
    while True:
        try:
            outside.recv(65_536)
        except BlockingIOError:
            return count
        count += 1


async def _fire(target: Target, captured: Sequence[bytes], count: int, *, from_outside: bool = False) -> None:
    hostile, before, tick = target.hostile, effects(target.at_work), target.at_work.tick
    for number in range(count):
        datagram = hostile.datagram(captured)
        if from_outside:
            target.send(datagram, stranger=True)
        else:
            target.feed(datagram, _NOWHERE if number % 50 == 0 else target.stranger)
        if number % _PER_TICK == _PER_TICK - 1:
            await asyncio.sleep(PERIOD_S)
            target.answers()
        if number % 100_000 == 99_999:
            gc.collect(1)  # as the service does between ticks: its own sweeps are seldom in simulated time
            target.must_be_unmoved(before, tick)
            del target.at_work.records[:-100]
    await asyncio.sleep(_SETTLED_S)
    target.must_be_unmoved(before, tick)


async def _teach_once(at_work: RobotAtWork) -> None:
    """Check that the channel still works."""
    now = asyncio.get_running_loop().time
    async with TeacherClient(at_work.other.device.folder, port=at_work.port, now=now) as teacher:
        assert (await teacher.send(Take)).accepted
        assert (await teacher.send(Teach, action="back")).accepted


def _strangers(folder: Path, count: int, *, seed: int) -> None:
    async def story() -> None:
        async with robot_at_work(folder) as at_work:
            target = Target(at_work, OscoreContext(at_work.pairing.device.folder), seed)
            captured = await target.capture()
            assert effects(at_work).rlas == 1
            began = at_work.tick
            await _fire(target, captured, count // 2)
            with target.strangers_without_limit():
                await _fire(target, captured, count // 2 - count // 50)
                await _fire(target, captured, count // 50, from_outside=True)
            assert at_work.tick - began >= count // _PER_TICK
            target.close()
            at_work.robot.counts = 500
            await _teach_once(at_work)

    run_jumping(story)
    mine, others = journal_of(folder)
    assert (mine.origin.teacher, others.origin.teacher) == ("local", "auto")


def _gone_mad(folder: Path, count: int, *, seed: int) -> None:
    """Send invalid requests with a valid key."""

    async def story() -> None:
        async with robot_at_work(folder) as at_work:
            target = Target(at_work, OscoreContext(at_work.pairing.device.folder), seed)
            await target.capture()
            before, tick, expected, answered = effects(at_work), at_work.tick, 0, 0
            target.answers()
            for number in range(count):
                datagram = target.hostile.protected(target.device, target.hostile.request())
                if number % 2:
                    target.feed(datagram, target.sender)
                else:
                    target.send(datagram, stranger=False)
                await asyncio.sleep(PERIOD_S)
                expected += len(datagram) <= LONGEST_DATAGRAM
                answered += target.answers()[0]
                del at_work.records[:-100]
            target.must_be_unmoved(before, tick)
            assert answered == expected > count // 2
            target.close()
            at_work.robot.counts = 500
            await _teach_once(at_work)

    run_jumping(story)
    assert [event.origin.teacher for event in journal_of(folder)] == ["local", "auto"]


def test_nothing_that_strangers_send_has_an_effect(tmp_path: Path) -> None:
    _strangers(tmp_path, 6_000, seed=1)


def test_a_device_gone_mad_is_answered_and_changes_nothing(tmp_path: Path) -> None:
    _gone_mad(tmp_path, 300, seed=2)


@pytest.mark.deep
def test_a_million_datagrams_of_strangers(tmp_path: Path) -> None:
    _strangers(tmp_path, 1_000_000, seed=3)


@pytest.mark.deep
def test_a_device_gone_mad_for_long(tmp_path: Path) -> None:
    _gone_mad(tmp_path, 50_000, seed=4)
