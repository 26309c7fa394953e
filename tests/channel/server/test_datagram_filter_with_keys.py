"""A device gets through a flood from a fresh socket, also if the flood copies its key id, datagrams or address."""

import random
from collections.abc import Iterator
from pathlib import Path

import aiocoap
import pytest

from kurt2rt.channel.security.oscore_context import OscoreContext
from kurt2rt.channel.security.pairing import pair
from kurt2rt.channel.server.datagram_filter import Counters, DatagramFilter, Limits, SocketAddress
from kurt2rt.channel.server.sealed_request import SealedRequest
from tests.channel.clock import Clock

HOME: SocketAddress = ("::ffff:10.0.0.7", 40_000, 0, 0)
"""The device's proven address."""
ACK = bytes([0x60, 0, 0, 1])
_RESEND_S = 0.1


def stranger(number: int) -> SocketAddress:
    return (f"::ffff:10.{number >> 16 & 255}.{number >> 8 & 255}.{number & 255}", 1024 + number % 60_000, 0, 0)


class Door:
    """A gate that knows one key, with a clock of its own."""

    def __init__(self, folder: Path, limits: Limits) -> None:
        pairing = pair(folder / "teachers", folder / "devices", "phone")
        self.device, self.robot = OscoreContext(pairing.device.folder), OscoreContext(pairing.teacher)
        self.clock, self.counters = Clock(), Counters()
        self.gate = DatagramFilter(limits, self.counters, self.clock, self._key_of)

    def _key_of(self, sealed: SealedRequest) -> OscoreContext | None:
        return self.robot if sealed.kid == self.robot.recipient_id else None

    def stop(self) -> bytes:
        """Return a new stop of the device."""
        outer, _ = self.device.protect(aiocoap.Message(code=aiocoap.POST, uri_path=("stop",), payload=b"\x82"))
        outer.mid, outer.mtype, outer.token = 7, aiocoap.NON, b"t"
        data: bytes = outer.encode()
        return data

    def forged(self, kid: bytes, number: int) -> bytes:
        """Return a forged request with a key id that a stranger read."""
        option = b"\x0c" + number.to_bytes(4, "big") + kid
        return bytes((0x50, 2, 0, 1, 0x90 | len(option))) + option + b"\xff" + bytes(30)

    def admitted(self, data: bytes, senders: int = 1, first: int = 0) -> int:
        return sum(self.gate.accepts(data, stranger(first + number)) for number in range(senders))


@pytest.fixture
def door(tmp_path: Path) -> Iterator[Door]:
    made = Door(tmp_path, Limits())
    yield made
    made.device.close()
    made.robot.close()


def test_a_fresh_socket_is_let_in_while_strangers_flood(door: Door) -> None:
    request = bytes([0x50, aiocoap.POST, 0, 1])
    assert door.admitted(request, senders=2000) == 40
    assert door.gate.accepts(door.stop(), stranger(9000))


def test_filter_forged_device_address_keeps_device_in(door: Door) -> None:
    door.gate.mark_proven(HOME)
    captured = door.stop()
    flood = [captured, door.forged(door.robot.recipient_id, 2**31), bytes([0x50, aiocoap.POST, 0, 1]), ACK]
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
    data = door.forged(door.robot.recipient_id, 5)
    assert door.admitted(data, senders=10_000) == 0
    assert checked == 500
    assert door.counters == Counters(received=10_000, forged=500, dropped_by_bucket=9500)
    door.clock.now_s += 0.02
    door.admitted(data, senders=1000)
    assert checked == 600


def test_keys_that_were_paired_over_and_over_leave_no_memory(tmp_path: Path) -> None:
    door = Door(tmp_path, Limits(proven_senders=3))
    (sealed,) = filter(None, [SealedRequest.parse(door.stop())])
    for number in range(10):
        door.gate._is_newest(SealedRequest(bytes((number,)), None, sealed.partial_iv, sealed.ciphertext))
    assert list(door.gate._keys) == [b"\x07", b"\x08", b"\x09"]
    door.device.close()
    door.robot.close()


@pytest.mark.parametrize("per_s", [4_000, 10_000])
def test_filter_stop_passes_within_half_a_second_of_flood(door: Door, per_s: int) -> None:
    """A stop is sent again every 0.1 s from a socket that the robot never heard of; time is the gate's own."""
    chance = random.Random(per_s)
    forged = door.forged(door.robot.recipient_id, 2**31)
    waits_s = []
    for stop in range(10):
        said_s = door.clock.now_s = door.clock.now_s + chance.random()
        door.admitted(forged, senders=600)  # the flood has used up what was saved
        for copy in range(1, 36):
            if door.gate.accepts(door.stop(), stranger(70_000 + stop)):
                break
            while door.clock.now_s < said_s + copy * _RESEND_S:
                door.clock.now_s += chance.expovariate(per_s)
                assert not door.gate.accepts(forged, stranger(chance.randrange(60_000)))
        waits_s.append(door.clock.now_s - said_s)
    assert max(waits_s) < 0.5
