"""Datagrams of strangers and of a faulty device, drawn from one seed."""

import math
import random
import socket
import struct
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import aiocoap
import cbor2
from aiocoap.optiontypes import OpaqueOption

from kurt2rt.channel.protocol.codec import BODIES, PATHS, build_request, decode_request, encode_request
from kurt2rt.channel.protocol.requests import Request
from kurt2rt.channel.security.oscore_context import OscoreContext
from kurt2rt.channel.server.datagram_filter import TokenBucket
from kurt2rt.core.decision.goal import PartialGoal
from kurt2rt.core.message_fields import WireError
from kurt2rt.core.rla.rla import Phase

_MOST_BYTES = 1600
_STRANGE_PATHS: tuple[tuple[str, ...], ...] = (
    *((), ("",), ("..", "stop"), ("state", "x"), ("STOP",), ("world", "..", "stop"), ("drive\x00",), ("a" * 255,)),
    *(("\u202estop",), (".well-known", "core", "x"), ("world",) * 40),
)
_METHODS = (aiocoap.GET, aiocoap.PUT, aiocoap.DELETE, aiocoap.FETCH, aiocoap.PATCH, aiocoap.iPATCH)
_TRICKS = ("../../x", "x\x00y", "\ud7ff\u202e", "/etc/passwd", "a" * 65, "a" * 900, "", "\n", "😀" * 70)
_ODD: tuple[Any, ...] = (
    *(None, True, False, -1, 2**53 + 1, 2**64 - 1, -(2**64), 2**70, -(2**200)),
    *(float("nan"), float("inf"), -float("inf"), 1e308, -0.0, 5e-324, 2.0001),
    *(b"", b"\x00" * 3, b"\xff" * 9, b"x" * 700),
    *([], {}, [[]], {"a": 1}, {1: 2}, [1] * 300, cbor2.CBORTag(0, "2020-01-01T00:00:00Z"), cbor2.CBORTag(4, [1, 2])),
    *(cbor2.undefined, cbor2.CBORSimpleValue(99)),
    *_TRICKS,
)
_RAW = (
    *(b"", b"\x81" * 900, b"\xa1" * 900, b"\x9f" * 500 + b"\xff" * 500, b"\x9b" + b"\xff" * 8, b"\x5b" + b"\x7f" * 8),
    *(b"\x7b" + b"\x00" * 7 + b"\xff", b"\xbf\xff", b"\xd9\xd9\xf7\x80", b"\xc2\x58\xff" + b"\xff" * 255),
    *(b"\xd8\x1c\x81\xd8\x1d\x00", b"\xff", b"\x80\x80", b"\x62\xc3\x28"),
)

UNLIMITED = TokenBucket(math.inf, 0.0)
"""Bucket that lets all strangers in."""


def outside() -> socket.socket:
    """Return the socket of a sender outside the robot's program."""
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.setblocking(False)
    sender.bind(("127.0.0.1", 0))
    return sender


def drained(sender: socket.socket) -> list[bytes]:
    """Return the datagrams that came back since the last call."""
    came = []
    with suppress(BlockingIOError):
        while True:
            came.append(sender.recv(65_536))
    return came


class HostileDatagrams:
    """Draws datagrams and requests; `now` tells the boot id and the tick of a robot, for what looks almost right."""

    def __init__(self, seed: int, now: Callable[[], tuple[bytes, int]]) -> None:
        self._chance = random.Random(seed)
        self._now = now
        self._number = 0

    def datagram(self, captured: Sequence[bytes]) -> bytes:
        """Return a datagram that a sender without a key can make from `captured`; it must have no effect."""
        share = self._chance.random()
        if share < 0.2:
            return self.noise()
        if share < 0.6:
            return self.mutated(self.plain())
        again = self._chance.choice(captured)
        if share < 0.65:
            return again
        # With another message id and token CoAP itself does not take it for a duplicate; neither is protected.
        token_ends = 4 + (again[0] & 0b1111)
        renumbered = again[:2] + self._chance.randbytes(token_ends - 2) + again[token_ends:]
        return renumbered if share < 0.75 else self.mutated(renumbered)

    def noise(self) -> bytes:
        """Random bytes; half of them begin like CoAP."""
        chance = self._chance
        noise = chance.randbytes(min(_MOST_BYTES, int(chance.expovariate(1 / 60))))
        if chance.random() < 0.5:
            return bytes((0x40 | chance.randrange(0x40), chance.randrange(8))) + noise
        return noise

    def plain(self) -> bytes:
        """Return a well-formed CoAP message without protection."""
        chance = self._chance
        message = aiocoap.Message(code=chance.choice((aiocoap.POST, *_METHODS)))
        path, payload = self._almost_right() if chance.random() < 0.7 else (self._strange_path(), self.payload())
        message.opt.uri_path = path
        message.payload = payload
        self.with_odd_options(message)
        return self._encoded(message)

    def mutated(self, datagram: bytes) -> bytes:
        """Return data with bits flipped, or bytes lost, inserted or doubled; sometimes unchanged."""
        chance, data = self._chance, bytearray(datagram)
        for _ in range(chance.choice((0, 0, 1, 1, 1, 2, 4, 16))):
            at = chance.randrange(len(data) + 1)
            match chance.randrange(5):
                case 0 if at < len(data):
                    data[at] ^= 1 << chance.randrange(8)
                case 1:
                    del data[at : at + chance.randrange(1, 9)]
                case 2:
                    data[at:at] = chance.randbytes(chance.randrange(1, 9))
                case 3:
                    data[at:at] = data[at : at + chance.randrange(1, 40)]
                case _:
                    del data[at:]
        return bytes(data[:_MOST_BYTES])

    def valid(self, path: str) -> Request:
        """Return a valid request with random fields."""
        boot, tick = self._now()
        chance = self._chance
        values: dict[str, Any] = {
            "boot": boot,
            "seen": tick,
            "seen_tick": tick,
            "command_id": chance.randbytes(8),
            "press_id": chance.randrange(2**40),
            "left_m_s": 0.2,
            "right_m_s": 0.2,
            "action": "forward",
            "appraisal": "bad",
            "behaviour": "turn_left",
            "ticks": 50,
            "decision_tick": None,
            "level": "basic",
            "alternative": False,
            "segments": tuple(range(chance.randrange(4))),
            "late": chance.choice((True, False)),
            "goal": PartialGoal((("x_m", 1.0), ("wall_left", 1.0)), 0.1),
            "value": 1,
            "rla_id": 1,
            "lesson": None,
            "phase": chance.choice(list(Phase)),
            "name": "evening",
            "to": None,
            "label": "a",
            "count": 3,
            "form": chance.choice(("table", "package")),
            "offset": chance.randrange(2**20),
            "world": None,
            "task": None,
            "fresh": False,
            "times": 3,
            "percent": 40,
            "upload": chance.randbytes(8),
            "part": b"part",
            "sha256": chance.randbytes(32),
            "dx_m": 0.1,
            "dy_m": 0.1,
            "x_m": 1.0,
            "y_m": 1.0,
            "heading_rad": 0.0,
        }
        return build_request(path, {name: values[name] for name in BODIES[path]})

    def payload(self) -> bytes:
        """Something that may be CBOR."""
        chance = self._chance
        share = chance.random()
        if share < 0.3:
            return chance.choice(_RAW)
        if share < 0.5:
            return chance.randbytes(chance.randrange(60))
        return cbor2.dumps(self._item(0))

    def request(self) -> aiocoap.Message:
        """Return a request for a key holder to protect, which the robot must refuse."""
        chance = self._chance
        while True:
            message = aiocoap.Message(code=aiocoap.POST)
            share = chance.random()
            if share < 0.6:
                path, message.payload = self._spoiled()
                message.opt.uri_path = path
            elif share < 0.8:
                message.opt.uri_path, message.payload = self._almost_right()
                message.code = chance.choice(_METHODS[1:])
            else:
                message.opt.uri_path, message.payload = self._strange_path(), self.payload()
            if chance.random() < 0.2:
                self.with_odd_options(message)
            if not is_order(message):
                return message

    def with_odd_options(self, message: aiocoap.Message) -> None:
        """Observe, blocks, No-Response, and values that are as large as they can be."""
        chance = self._chance
        match chance.randrange(9):
            case 0:
                message.opt.observe = chance.choice((0, 1, 2**24 - 1))
            case 1:
                message.opt.block1 = (chance.randrange(2**20), chance.random() < 0.5, chance.randrange(7))
            case 2:
                message.opt.block2 = (chance.randrange(2**20), False, chance.randrange(8))
            case 3:
                message.opt.no_response = chance.randrange(256)
            case 4:
                message.opt.content_format = chance.randrange(2**16)
            case 5:
                message.opt.echo = chance.randbytes(chance.choice((1, 8, 40)))
            case 6:
                message.opt.etag = chance.randbytes(8)
            case 7:
                message.opt.uri_host = chance.choice(("a" * 255, "x\x00", "\u202e"))
            case _:
                number = chance.choice((9, 2049, 65000, 65535))
                value = chance.randbytes(chance.choice((0, 8)))
                message.opt.add_option(OpaqueOption(aiocoap.numbers.OptionNumber(number), value))

    def protected(self, device: OscoreContext, message: aiocoap.Message) -> bytes:
        """Return the datagram of a key holder."""
        outer, _ = device.protect(message)
        return self._encoded(outer)

    def _encoded(self, message: aiocoap.Message) -> bytes:
        chance = self._chance
        self._number += 1
        message.mid, message.token = self._number % 2**16, chance.randbytes(chance.choice((0, 2, 4, 8, 8, 8)))
        message.mtype = chance.choice((aiocoap.CON, aiocoap.NON, aiocoap.NON, aiocoap.NON))
        encoded: bytes = message.encode()
        return encoded

    def _almost_right(self) -> tuple[tuple[str, ...], bytes]:
        path = self._chance.choice(list(PATHS))
        return tuple(path.strip("/").split("/")), encode_request(self.valid(path))

    def _strange_path(self) -> tuple[str, ...]:
        if self._chance.random() < 0.5:
            return self._chance.choice(_STRANGE_PATHS)
        return tuple(self._chance.choice(sorted(PATHS)).strip("/").split("/"))

    def _spoiled(self) -> tuple[tuple[str, ...], bytes]:
        chance = self._chance
        path, payload = self._almost_right()
        body: Any = cbor2.loads(payload)
        match chance.randrange(6):
            case 0 if body:
                body[chance.randrange(len(body))] = chance.choice(_ODD)
            case 1:
                body.insert(chance.randrange(len(body) + 1), chance.choice(_ODD))
            case 2 if body:
                del body[chance.randrange(len(body))]
            case 3:
                body = {str(number): each for number, each in enumerate(body)}
            case 4:
                return path, self.mutated(payload)
            case _:
                return path, self.payload()
        return path, cbor2.dumps(body)

    def _item(self, depth: int) -> Any:
        chance = self._chance
        if depth > 4 or chance.random() < 0.5:
            if chance.random() < 0.1:
                return struct.unpack(">d", chance.randbytes(8))[0]
            return chance.choice(_ODD)
        if chance.random() < 0.7:
            return [self._item(depth + 1) for _ in range(chance.randrange(6))]
        return {chance.choice(("a", "b", 1, b"k")): self._item(depth + 1) for _ in range(chance.randrange(4))}


def is_order(message: aiocoap.Message) -> bool:
    """Return whether the robot has to carry out a request of a key holder."""
    path = "/" + "/".join(message.opt.uri_path)
    if message.code == aiocoap.GET:
        return path == "/state"
    if message.code != aiocoap.POST or path not in PATHS:
        return False
    try:
        decode_request(path, message.payload)
    except WireError:
        return False
    return True
