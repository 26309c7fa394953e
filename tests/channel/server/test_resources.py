"""The robot's resources: what a stranger gets, what a key holder gets, and what a request leaves behind."""

import asyncio
import logging
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import aiocoap
import cbor2
import pytest
from aiocoap.pipe import Pipe

from kurt2rt.channel.protocol.codec import (
    CONTENT_FORMAT,
    PATHS,
    decode_answer,
    decode_state,
    encode_request,
    encode_state,
    path_of,
)
from kurt2rt.channel.protocol.requests import HelloRequest, LessonsRequest, Request, StopRequest
from kurt2rt.channel.security.oscore_context import OscoreContext
from kurt2rt.channel.security.paired_devices import Teachers
from kurt2rt.channel.security.pairing import local_pairing, pair
from kurt2rt.channel.server.channel import open_channel
from kurt2rt.channel.server.resources import RobotSite
from kurt2rt.core.decision.decision import DecisionCause
from tests.channel.channel_fixture import ChannelFixture, turns
from tests.channel.sides import answer_challenge, carried, header_of
from tests.channel.states import state

CODES = (aiocoap.GET, aiocoap.POST, aiocoap.PUT, aiocoap.DELETE, aiocoap.FETCH)
EVERYWHERE = (*PATHS, "/state", "/", "/nothing/here", "/.well-known/core")
CORE = "/.well-known/core"


def plain(path: str, code: Any = aiocoap.POST, payload: bytes = b"", **options: Any) -> Any:
    message = aiocoap.Message(code=code, payload=payload, **options)
    message.opt.uri_path = tuple(path.strip("/").split("/")) if path != "/" else ()
    return message


class Phone:
    """A paired device without a socket: what it sends goes to the site as it would from the network."""

    def __init__(self, site: RobotSite, keys: OscoreContext) -> None:
        self.site = site
        self.keys = keys

    async def call(self, message: Any) -> Any:
        """Return the answer to a protected request, decrypted with the device's keys."""
        protected, request_id = self.keys.protect(message)
        (event,) = await answers(self.site, carried(protected))
        assert event.is_last
        answer, _ = self.keys.unprotect(carried(event.message), request_id)
        return answer

    async def post(self, request: Request) -> Any:
        """Return the answer to a request of the wire."""
        return await self.call(plain(path_of(request), payload=encode_request(request), content_format=CONTENT_FORMAT))


class School:
    """A robot at its desk, with two paired devices, ann and ben."""

    def __init__(self, folder: Path) -> None:
        self.pairings = {name: pair(folder / "teachers", folder / "devices", name) for name in ("ann", "ben")}
        self.teachers = Teachers(folder / "teachers")
        self.desk = ChannelFixture(keys=self.teachers)
        self.site = self.desk.site
        self._phones: list[OscoreContext] = []

    def keys(self, name: str = "ann") -> OscoreContext:
        keys = OscoreContext(self.pairings[name].device.folder)
        self._phones.append(keys)
        answer_challenge(keys, self.teachers.find(header_of(keys)))
        return keys

    def phone(self, name: str = "ann") -> Phone:
        return Phone(self.site, self.keys(name))

    def close(self) -> None:
        for keys in self._phones:
            keys.close()
        self.teachers.close()


async def answers(site: RobotSite, message: Any) -> list[Any]:
    """Return the responses of the site to a request."""
    events: list[Any] = []
    pipe = Pipe(message, logging.getLogger("aiocoap.test"))
    pipe.on_event(_noting(events))
    await site.render_to_pipe(pipe)
    return events


def _noting(events: list[Any]) -> Callable[[Any], bool]:
    def note(event: Any) -> bool:
        events.append(event)
        return True

    return note


@pytest.fixture
def school(tmp_path: Path) -> Iterator[School]:
    school = School(tmp_path)
    yield school
    school.close()


# Strangers.


@pytest.mark.parametrize("code", CODES, ids=str)
async def test_without_keys_everything_but_discovery_is_refused(school: School, code: Any) -> None:
    for path in EVERYWHERE:
        payload = cbor2.dumps([b"12345678", None]) if path == "/stop" else b""
        (event,) = await answers(school.site, carried(plain(path, code, payload)))
        assert event.is_last
        if (code, path) == (aiocoap.GET, CORE):
            assert event.message.code == aiocoap.CONTENT
        else:
            assert (event.message.code, event.message.payload) == (aiocoap.UNAUTHORIZED, b""), path
    assert school.desk.run().decision.cause is DecisionCause.UNKNOWN
    assert school.site.observers == 0


async def test_discovery_names_every_resource(school: School) -> None:
    told, more = b"", True
    while more:
        request = plain(CORE, aiocoap.GET)
        request.opt.block2 = (len(told) // 32, False, 1)
        (event,) = await answers(school.site, carried(request))
        told += event.message.payload
        more = event.message.opt.block2.more
        assert event.message.opt.content_format == 40
    assert told.decode().split(",") == ["</state>;obs;osc;ct=60", *(f"<{path}>;osc" for path in PATHS)]
    whole = await school.phone().call(plain(CORE, aiocoap.GET))
    assert (whole.payload, whole.opt.block2) == (told, None)


async def test_every_bit_that_is_changed_on_the_way_meets_silence(school: School) -> None:
    keys = school.keys()
    await Phone(school.site, keys).post(HelloRequest())
    protected, _ = keys.protect(plain("/stop", payload=encode_request(StopRequest(b"12345678"))))
    for place in range(len(protected.payload)):
        broken = carried(protected)
        changed = bytearray(broken.payload)
        changed[place] ^= 1 << place % 8
        broken.payload = bytes(changed)
        assert await answers(school.site, broken) == []
    assert school.desk.run().decision.cause is DecisionCause.UNKNOWN


@pytest.mark.parametrize("payload", [b"", b"\x00", b"\xff" * 8, bytes(13)])
async def test_a_message_that_only_looks_protected_meets_silence(school: School, payload: bytes) -> None:
    kid = school.keys().sender_id
    for option in (b"", b"\x09\x00" + kid, b"\x0d" + bytes(5) + kid, b"\xff\xff", b"\x08" + kid):
        message = plain("/hello", payload=payload, oscore=option)
        assert await answers(school.site, carried(message)) == []


async def test_a_request_that_was_recorded_is_not_carried_out_again(school: School) -> None:
    keys = school.keys()
    phone = Phone(school.site, keys)
    await phone.post(HelloRequest())
    protected, _ = keys.protect(plain("/hello", payload=cbor2.dumps([])))
    assert len(await answers(school.site, carried(protected))) == 1
    assert await answers(school.site, carried(protected)) == []


# Key holders.


@pytest.mark.parametrize("code", [code for code in CODES if code != aiocoap.POST], ids=str)
async def test_every_path_takes_post_alone(school: School, code: Any) -> None:
    phone = school.phone()
    for path in PATHS:
        answer = await phone.call(plain(path, code))
        assert answer.code == aiocoap.METHOD_NOT_ALLOWED, path


@pytest.mark.parametrize("code", CODES, ids=str)
async def test_site_unknown_path_is_not_found(school: School, code: Any) -> None:
    phone = school.phone()
    for segments in ((), ("nothing", "here"), ("hello", "there"), ("world", ""), ("", "hello")):
        message = aiocoap.Message(code=code)
        message.opt.uri_path = segments
        assert (await phone.call(message)).code == aiocoap.NOT_FOUND, segments


@pytest.mark.parametrize("payload", [b"", b"\xff", b"\x81", cbor2.dumps({}), cbor2.dumps([1] * 9), bytes(2000)])
async def test_site_malformed_request_is_bad_request(school: School, payload: bytes) -> None:
    phone = school.phone()
    for path in PATHS:
        answer = await phone.call(plain(path, payload=payload))
        assert (answer.code, answer.opt.content_format) == (aiocoap.BAD_REQUEST, CONTENT_FORMAT), path
        told = decode_answer(answer.payload)
        assert told["why"] == "malformed"
        assert told["text"]
    assert school.desk.runtime.inbox.pop_all() == ()


async def test_site_internal_error_is_counted_and_next_request_works(
    school: School, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: object) -> None:
        raise ZeroDivisionError

    phone = school.phone()
    with monkeypatch.context() as patch:
        patch.setattr(school.desk.handler.lessons, "newest", fail)
        answer = await phone.post(LessonsRequest(3))
    assert (answer.code, school.site.failures) == (aiocoap.INTERNAL_SERVER_ERROR, 1)
    assert (await phone.post(LessonsRequest(3))).code == aiocoap.CHANGED


# Pictures.


class Observer:
    """A device that looks at the robot."""

    def __init__(self, phone: Phone, message: Any) -> None:
        self.keys = phone.keys
        protected, self._request_id = phone.keys.protect(message)
        self.events: list[Any] = []
        pipe = Pipe(carried(protected), logging.getLogger("aiocoap.test"))
        pipe.on_event(_noting(self.events))
        self._task = asyncio.create_task(phone.site.render_to_pipe(pipe))

    async def ticks(self) -> list[int]:
        """Ticks of the pictures that came since the last call."""
        await turns()
        answers = [self.keys.unprotect(carried(event.message), self._request_id)[0] for event in self.events]
        self.events.clear()
        return [decode_state(answer.payload).tick for answer in answers]

    async def removed(self) -> None:
        """Cancel the request, as aiocoap does for a device that is gone."""
        self._task.cancel()
        await asyncio.wait([self._task])


def look(*, observe: int | None = 0) -> Any:
    message = plain("/state", aiocoap.GET)
    if observe is not None:
        message.opt.observe = observe
    return message


def show(school: School, tick: int) -> None:
    school.site.publish(encode_state(state(tick=tick)))


async def test_observer_slow_gets_newest_state_and_none_older(school: School) -> None:
    show(school, 5)
    observer = Observer(school.phone(), look())
    assert await observer.ticks() == [5]
    for tick in (10, 15, 20):
        show(school, tick)
    assert await observer.ticks() == [20]
    skipped = school.site.states_skipped
    assert skipped > 0
    await observer.removed()
    assert school.site.states_skipped == skipped  # also of those who are gone


async def test_state_get_before_first_state_waits(school: School) -> None:
    call = asyncio.create_task(school.phone().call(look(observe=None)))
    await turns()
    assert not call.done()
    show(school, 5)
    assert decode_state((await call).payload).tick == 5
    assert school.site.observers == 0


async def test_observer_silent_for_a_second_gets_confirmable_state(
    school: School, monkeypatch: pytest.MonkeyPatch
) -> None:
    loop = asyncio.get_running_loop()
    later_s, time_of = 0.0, loop.time
    monkeypatch.setattr(loop, "time", lambda: time_of() + later_s)
    phone = school.phone()
    observer = Observer(phone, look())

    async def is_asked() -> bool:
        observer.events.clear()
        show(school, 5)
        await turns()
        (event,) = observer.events
        confirmed: bool = event.message.transport_tuning.reliability
        return confirmed

    await is_asked()
    assert not await is_asked()
    later_s += 1.0
    assert await is_asked()
    assert not await is_asked()
    later_s += 1.0
    await phone.post(HelloRequest())  # he is there
    assert not await is_asked()
    await observer.removed()


# Over a real socket.


async def test_channel_without_paired_device_listens_on_loopback(desk: ChannelFixture, tmp_path: Path) -> None:
    local_pairing(tmp_path / "teachers", tmp_path / "devices")
    teachers = Teachers(tmp_path / "teachers")
    async with open_channel(desk.runtime, teachers, 0, desk.parts) as channel:
        (tokens,) = channel.endpoint._context.request_interfaces
        transport = tokens.token_interface.message_interface.transport
        assert transport.get_extra_info("socket").getsockname()[0] == "::ffff:127.0.0.1"
    teachers.close()
