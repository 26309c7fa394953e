"""Hostile datagrams by the hundred thousand: nothing breaks, nothing counts, and the robot goes on ticking."""

import asyncio
import gc
import socket
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import aiocoap
import pytest

from kurt2rt.channel.protocol.codec import encode_request
from kurt2rt.channel.protocol.requests import HelloRequest, LessonsRequest, StopRequest
from kurt2rt.channel.security.oscore_context import OscoreContext
from kurt2rt.channel.server.datagram_filter import LONGEST_DATAGRAM, SocketAddress
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.teaching.commands import Drive, HoldAction, Resume, Take, Teach
from kurt2rt.teacher import TeacherClient
from tests.channel.hostile_datagrams import UNLIMITED, HostileDatagrams, drained, outside
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


def effects(at_work: RobotAtWork) -> dict[str, object]:
    """Return all that a command could have changed."""
    school, system = at_work.runtime.handler, at_work.runtime.level.system
    return {
        "teacher": school.authority.teacher,
        "phase": school.phase,
        "stopped": school.stops.active,
        "session": school.clock.session,
        "rlas": len(system),
        "lessons": system.history.standing,
        "corrections": school.corrections_at[BASIC],
        "waiting": at_work.runtime.inbox.pop_all(),
    }


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
        self._outside, self._stranger = outside(), outside()
        self.sender: SocketAddress = ("::ffff:127.0.0.1", self._outside.getsockname()[1], 0, 0)
        """Of what the device sends: known to hold a key."""
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
        return len(drained(self._outside)), len(drained(self._stranger))

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

    def must_be_unmoved(self, before: dict[str, object], tick: int) -> None:
        assert not self.at_work.ended
        assert self.errors == []
        assert self.at_work.channel.failures == 0
        assert self._endpoint.counters.failed == 0, self._endpoint.newest_failure
        assert self.at_work.moved_since(tick) == []
        assert effects(self.at_work) == before


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


@pytest.mark.parametrize(("count", "seed"), [(6_000, 1), pytest.param(1_000_000, 3, marks=pytest.mark.deep)])
def test_nothing_that_strangers_send_has_an_effect(tmp_path: Path, count: int, seed: int) -> None:
    async def story() -> None:
        async with robot_at_work(tmp_path) as at_work:
            target = Target(at_work, OscoreContext(at_work.pairing.device.folder), seed)
            captured = await target.capture()
            assert effects(at_work)["rlas"] == 1
            began = at_work.tick
            await _fire(target, captured, count // 2)
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(at_work.channel.endpoint._filter, "_strangers", UNLIMITED)
                await _fire(target, captured, count // 2 - count // 50)
                await _fire(target, captured, count // 50, from_outside=True)
            assert at_work.tick - began >= count // _PER_TICK
            target.close()
            at_work.robot.counts = 500
            await _teach_once(at_work)

    run_jumping(story)
    assert [event.origin.teacher for event in journal_of(tmp_path)] == ["local", "auto"]


@pytest.mark.parametrize(("count", "seed"), [(300, 2), pytest.param(50_000, 4, marks=pytest.mark.deep)])
def test_a_device_gone_mad_is_answered_and_changes_nothing(tmp_path: Path, count: int, seed: int) -> None:
    """Its requests are invalid, its key is valid."""

    async def story() -> None:
        async with robot_at_work(tmp_path) as at_work:
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
    assert [event.origin.teacher for event in journal_of(tmp_path)] == ["local", "auto"]
