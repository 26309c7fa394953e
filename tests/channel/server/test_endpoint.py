"""The robot's UDP port, with real sockets on loopback."""

import asyncio
import weakref
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

import aiocoap
import pytest
from aiocoap.error import ConRetransmitsExceeded, NetworkError
from aiocoap.messagemanager import MessageManager

from kurt2rt.channel.protocol.schema import ChannelError
from kurt2rt.channel.server.datagram_filter import Counters, Limits
from kurt2rt.channel.server.endpoint import Endpoint, _unless_reachable, open_endpoint
from tests.channel.clock import Clock
from tests.channel.jumping_loop import run_jumping
from tests.patience import PATIENCE_S

PING = bytes([0x40, 0, 0x12, 0x34])
PONG = bytes([0x70, 0, 0x12, 0x34])


@pytest.mark.parametrize(
    ("error", "reachable", "ended"),
    [
        (ConRetransmitsExceeded("4 times"), True, False),
        (ConRetransmitsExceeded("4 times"), False, True),
        (NetworkError("no route"), True, True),
        (NetworkError("no route"), False, True),
    ],
)
def test_endpoint_keeps_observations_of_a_reachable_sender_only(error: Exception, reachable: bool, ended: bool) -> None:
    ends: list[Exception] = []
    dispatch = _unless_reachable(lambda error, _: ends.append(error), lambda _: reachable)
    dispatch(error, "a device")
    assert bool(ends) is ended


class Site:
    """Answers each request with what it was asked; /silence it does not answer, at /fault it fails."""

    def __init__(self) -> None:
        self.mark_proven: Callable[[Any], None] | None = None
        self.asked = asyncio.Event()
        self.may_answer = asyncio.Event()
        self.may_answer.set()
        self.requests: list[weakref.ref[Any]] = []

    async def render_to_pipe(self, pipe: Any) -> None:
        self.requests.append(weakref.ref(pipe.request))
        self.asked.set()
        path = "/".join(pipe.request.opt.uri_path)
        if path == "fault":
            raise ZeroDivisionError("the site is wrong")
        if path == "silence":
            return
        if path == "key" and self.mark_proven is not None:
            self.mark_proven(pipe.request.remote)
        await self.may_answer.wait()
        pipe.add_response(aiocoap.Message(code=aiocoap.CHANGED, payload=pipe.request.payload), is_last=True)


class Sender(asyncio.DatagramProtocol):
    """One who sends datagrams to the robot, and reads what comes back."""

    transport: asyncio.DatagramTransport

    def __init__(self) -> None:
        self.received: asyncio.Queue[bytes] = asyncio.Queue()
        self.refused = asyncio.Event()
        self._number = 0

    def datagram_received(self, data: bytes, _: object) -> None:
        self.received.put_nowait(data)

    def error_received(self, _: Exception) -> None:
        self.refused.set()

    def send(self, data: bytes) -> None:
        self.transport.sendto(data)

    def post(self, path: str, payload: bytes = b"", kind: aiocoap.Type = aiocoap.NON) -> bytes:
        """Send a request; return its token."""
        self._number += 1
        message = aiocoap.Message(code=aiocoap.POST, uri_path=(path,), payload=payload)
        message.mid, message.mtype = self._number, kind
        message.token = self._number.to_bytes(2, "big")
        self.send(message.encode())
        token: bytes = message.token
        return token

    async def answer(self) -> aiocoap.Message:
        async with asyncio.timeout(PATIENCE_S):
            return aiocoap.Message.decode(await self.received.get())

    async def ping(self) -> None:
        """Wait until the robot has read all datagrams so far."""
        self.send(PING)
        async with asyncio.timeout(PATIENCE_S):
            while await self.received.get() != PONG:
                pass

    def close(self) -> None:
        self.transport.close()


class Robot:
    """A site on an open port."""

    def __init__(self, site: Site, endpoint: Endpoint) -> None:
        self.site = site
        self.endpoint = endpoint
        self._senders: list[Sender] = []

    async def sender(self, host: str = "127.0.0.1") -> Sender:
        transport, sender = await asyncio.get_running_loop().create_datagram_endpoint(
            Sender, remote_addr=(host, self.endpoint.port)
        )
        sender.transport = transport
        self._senders.append(sender)
        return sender

    async def close(self) -> None:
        for sender in self._senders:
            sender.close()
        await self.endpoint.close()


@asynccontextmanager
async def robot_at(host: str = "127.0.0.1", **options: Any) -> AsyncIterator[Robot]:
    site = Site()
    robot = Robot(site, await open_endpoint(site, host, 0, **options))
    site.mark_proven = robot.endpoint.mark_proven
    try:
        yield robot
    finally:
        await robot.close()


async def must_answer(listens: str, asked: str) -> None:
    """Check that a robot which listens at one address answers a request to another."""
    async with robot_at(listens) as robot:
        sender = await robot.sender(asked)
        token = sender.post("echo", b"forward")
        answer = await sender.answer()  # a connected socket takes it from the asked address alone
        assert (answer.code, answer.token, answer.payload) == (aiocoap.CHANGED, token, b"forward")
        assert robot.endpoint.counters == Counters(received=1)


@pytest.mark.parametrize(
    ("listens", "asked"),
    [("127.0.0.1", "127.0.0.1"), ("::1", "::1"), ("::", "127.0.0.1"), ("::", "::1"), ("::", "127.0.0.2")],
)
async def test_a_request_is_answered(listens: str, asked: str) -> None:
    await must_answer(listens, asked)


@pytest.mark.parametrize("second", ["127.0.0.1", "::"])
async def test_a_second_robot_on_the_port_is_refused(second: str) -> None:
    async with robot_at() as robot:
        with pytest.raises(ChannelError, match=f" {robot.endpoint.port} "):
            await open_endpoint(Site(), second, robot.endpoint.port)


@pytest.mark.parametrize(
    ("host", "port", "why"),
    [
        ("192.0.2.1", 0, "192.0.2.1 is not an address of this machine"),
        ("kurt", 0, "'kurt' is not an address"),
        ("::", 70000, "UDP port 70000 at :: cannot be opened"),
    ],
)
async def test_endpoint_unusable_address_raises_one_line(host: str, port: int, why: str) -> None:
    with pytest.raises(ChannelError, match=why) as refused:
        await open_endpoint(Site(), host, port)
    assert "\n" not in str(refused.value)


async def test_endpoint_flood_of_strangers_leaves_teacher_alone() -> None:
    clock = Clock()
    async with robot_at(limits=Limits(strangers_at_once=3, strangers_per_s=1), now=clock) as robot:
        teacher, one, other = await robot.sender(), await robot.sender(), await robot.sender()
        teacher.post("key")
        await teacher.answer()
        for _ in range(20):
            one.post("echo")
            other.post("echo")
        await teacher.ping()
        assert robot.endpoint.counters.dropped_by_bucket == 40 - 2
        assert robot.endpoint.proven_senders == 1
        teacher.post("echo", b"stop")
        assert (await teacher.answer()).payload == b"stop"
        clock.now_s += 1
        other.post("echo", b"patience")
        while (await other.answer()).payload != b"patience":
            pass


async def test_endpoint_library_error_is_counted_and_next_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(*_: object) -> None:
        raise AssertionError("backlogs relation violated")

    async with robot_at() as robot:
        sender = await robot.sender()
        with monkeypatch.context() as patch:
            patch.setattr(MessageManager, "_process_request", wrong)
            sender.post("echo")
            await sender.ping()
        assert robot.endpoint.counters.failed == 1
        assert "backlogs relation violated" in robot.endpoint.newest_failure
        sender.post("echo", b"still here")
        assert (await sender.answer()).payload == b"still here"


def test_close_with_unanswered_request_raises_nothing_later() -> None:
    errors: list[dict[str, Any]] = []

    async def story() -> None:
        asyncio.get_running_loop().set_exception_handler(lambda _, context: errors.append(context))
        async with robot_at() as robot:
            robot.site.may_answer.clear()
            sender = await robot.sender()
            sender.post("echo", kind=aiocoap.CON)
            await robot.site.asked.wait()
        await asyncio.sleep(1.0)  # past aiocoap's EMPTY_ACK_DELAY

    run_jumping(story)
    assert errors == []
