"""A flood gets its rate and no more, and a device gets through it, also if it copies key id, datagrams or address."""

import random
from collections.abc import Iterable

import aiocoap
import pytest

from kurt2rt.channel.security.oscore_context import OscoreContext
from kurt2rt.channel.server.datagram_filter import Counters, DatagramFilter, Limits, SocketAddress, may_be_request
from kurt2rt.channel.server.sealed_request import SealedRequest
from tests.channel.clock import Clock
from tests.channel.sides import Sides

REQUEST = bytes([0x50, aiocoap.POST, 0, 1])
ACK = bytes([0x60, 0, 0, 1])
_RESEND_S = 0.1


def sender(number: int) -> SocketAddress:
    return (f"::ffff:10.{number >> 16 & 255}.{number >> 8 & 255}.{number & 255}", 1024 + number % 60_000, 0, 0)


HOME = sender(90_000)
"""The device's proven address."""


class Door:
    """A gate that knows one key, with a clock of its own."""

    def __init__(self, sides: Sides, limits: Limits) -> None:
        self.sides = sides
        self.clock, self.counters = Clock(), Counters()
        self.gate = DatagramFilter(limits, self.counters, self.clock, self._key_of)

    def _key_of(self, sealed: SealedRequest) -> OscoreContext | None:
        return self.sides.robot if sealed.kid == self.sides.robot.recipient_id else None

    def stop(self) -> bytes:
        """Return a new stop of the device."""
        return self.sides.datagram(aiocoap.Message(code=aiocoap.POST, uri_path=("stop",), payload=b"\x82"))

    def forged(self, number: int) -> bytes:
        """Return a forged request with the key id of the device, which a stranger read."""
        kid: bytes = self.sides.robot.recipient_id
        option = b"\x0c" + number.to_bytes(4, "big") + kid
        return bytes((0x50, 2, 0, 1, 0x90 | len(option))) + option + b"\xff" + bytes(30)

    def admitted(self, senders: Iterable[int], data: bytes = REQUEST) -> int:
        """Return how many of these senders get in, each with the same datagram."""
        return sum(self.gate.accepts(data, sender(number)) for number in senders)


@pytest.fixture
def door(sides: Sides) -> Door:
    return Door(sides, Limits())


def test_filter_forged_addresses_share_strangers_rate(door: Door) -> None:
    assert door.admitted(range(2000)) == 40
    assert door.counters == Counters(received=2000, dropped_by_bucket=1960)
    assert door.gate.accepts(door.stop(), sender(9000))  # a fresh socket of a device
    door.clock.now_s += 1
    assert door.admitted(range(1000)) == 40


def test_filter_proven_sender_has_limited_rate(door: Door) -> None:
    door.gate.mark_proven(sender(1))
    assert door.admitted([1] * 1000) == 200
    door.gate.mark_proven(sender(1))  # proving it again fills nothing
    assert door.admitted([1]) == 0
    door.clock.now_s += 0.5
    assert door.admitted([1] * 1000) == 100


def test_filter_too_many_proven_drops_longest_silent(sides: Sides) -> None:
    door = Door(sides, Limits(strangers_at_once=0, strangers_per_s=0, proven_senders=3))
    for number in (1, 2, 3):
        door.gate.mark_proven(sender(number))
    assert door.admitted([1]) == 1
    door.gate.mark_proven(sender(4))
    assert door.gate.proven_senders == 3
    assert [door.admitted([number]) for number in (1, 2, 3, 4)] == [1, 0, 1, 1]


@pytest.mark.parametrize(
    ("data", "passes"),
    [
        (bytes([0x40, 1, 0, 1]), True),  # CON GET
        (bytes([0x52, 2, 0, 1, 7, 7]), True),  # NON POST with a token
        (bytes([0x40, 0, 0, 1]), True),  # ping
        (ACK, True),
        (bytes([0x70, 0, 0, 1]), True),  # RST
        (b"", False),
        (bytes([0x40, 1, 0]), False),
        (bytes([0x80, 1, 0, 1]), False),  # version 2
        (bytes([0x50, 0, 0, 1]), False),  # an empty NON
        (bytes([0x60, 0, 0, 1, 0]), False),  # an ACK that is empty, and yet is not
        (bytes([0x61, 0, 0, 1]), False),
        (bytes([0x60, 1, 0, 1]), False),  # a request in an ACK
        (bytes([0x50, 69, 0, 1]), False),  # 2.05
        (bytes([0x50, 7, 0, 1]), True),  # iPATCH, the last method
        (bytes([0x50, 8, 0, 1]), False),  # no method yet
        (bytes([0x59, 1, 0, 1]) + bytes(9), False),  # token of 9
        (bytes([0x50, 2, 0, 1, 0xFF]) + bytes(1495), True),
        (bytes([0x50, 2, 0, 1, 0xFF]) + bytes(1496), False),
    ],
)
def test_the_first_four_bytes_tell_what_may_be_a_request(data: bytes, passes: bool) -> None:
    assert may_be_request(data) is passes


def test_filter_forged_device_address_keeps_device_in(door: Door) -> None:
    door.gate.mark_proven(HOME)
    captured = door.stop()
    flood = [captured, door.forged(2**31), REQUEST, ACK]
    assert [door.gate.accepts(data, HOME) for data in (captured, door.stop())] == [True, True]
    for data in flood * 100:
        door.gate.accepts(data, HOME)
    assert not door.gate.accepts(ACK, HOME)  # the address has nothing left
    assert all(door.gate.accepts(door.stop(), HOME) for _ in range(150))


def test_no_more_tags_are_checked_than_the_limit_says(door: Door, monkeypatch: pytest.MonkeyPatch) -> None:
    checked = 0

    def check(_: SealedRequest, __: object) -> bool:
        nonlocal checked
        checked += 1
        return False

    monkeypatch.setattr(SealedRequest, "fits", check)
    data = door.forged(5)
    assert door.admitted(range(10_000), data) == 0
    assert checked == 500
    assert door.counters == Counters(received=10_000, forged=500, dropped_by_bucket=9500)
    door.clock.now_s += 0.02
    door.admitted(range(1000), data)
    assert checked == 600


def test_keys_that_were_paired_over_and_over_leave_no_memory(sides: Sides) -> None:
    door = Door(sides, Limits(proven_senders=3))
    (sealed,) = filter(None, [SealedRequest.parse(door.stop())])
    for number in range(10):
        door.gate._is_newest(SealedRequest(bytes((number,)), None, sealed.partial_iv, sealed.ciphertext))
    assert list(door.gate._keys) == [b"\x07", b"\x08", b"\x09"]


@pytest.mark.parametrize("per_s", [4_000, 10_000])
def test_filter_stop_passes_within_half_a_second_of_flood(door: Door, per_s: int) -> None:
    """A stop is sent again every 0.1 s from a socket that the robot never heard of; time is the gate's own."""
    chance = random.Random(per_s)
    forged = door.forged(2**31)
    waits_s = []
    for stop in range(10):
        said_s = door.clock.now_s = door.clock.now_s + chance.random()
        door.admitted(range(600), forged)  # the flood has used up what was saved
        for copy in range(1, 36):
            if door.gate.accepts(door.stop(), sender(70_000 + stop)):
                break
            while door.clock.now_s < said_s + copy * _RESEND_S:
                door.clock.now_s += chance.expovariate(per_s)
                assert not door.gate.accepts(forged, sender(chance.randrange(60_000)))
        waits_s.append(door.clock.now_s - said_s)
    assert max(waits_s) < 0.5
