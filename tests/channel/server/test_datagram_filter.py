import aiocoap
import pytest

from kurt2rt.channel.server.datagram_filter import Counters, DatagramFilter, Limits, SocketAddress, may_be_request
from tests.channel.clock import Clock

REQUEST = bytes([0x50, aiocoap.POST, 0, 1])


def sender(number: int) -> SocketAddress:
    return ("::ffff:10.0.0.7", number, 0, 0)


class Door:
    """A gate with a clock of its own."""

    def __init__(self, limits: Limits) -> None:
        self.clock = Clock()
        self.counters = Counters()
        self.gate = DatagramFilter(limits, self.counters, self.clock)

    def let_in(self, number: int, tries: int, data: bytes = REQUEST) -> int:
        return sum(self.gate.accepts(data, sender(number)) for _ in range(tries))


def test_filter_forged_addresses_share_strangers_rate() -> None:
    door = Door(Limits(strangers_at_once=40, strangers_per_s=40))
    assert sum(door.let_in(number, tries=1) for number in range(1000)) == 40
    assert door.counters == Counters(received=1000, dropped_by_bucket=960)
    door.clock.now_s += 1
    assert sum(door.let_in(number, tries=1) for number in range(1000)) == 40


def test_filter_proven_sender_has_limited_rate() -> None:
    door = Door(Limits(proven_at_once=200, proven_per_s=200))
    door.gate.mark_proven(sender(1))
    assert door.let_in(1, tries=1000) == 200
    door.gate.mark_proven(sender(1))  # proving it again fills nothing
    assert door.let_in(1, tries=1000) == 0
    door.clock.now_s += 0.5
    assert door.let_in(1, tries=1000) == 100


def test_filter_too_many_proven_drops_longest_silent() -> None:
    door = Door(Limits(strangers_at_once=0, strangers_per_s=0, proven_senders=3))
    for number in (1, 2, 3):
        door.gate.mark_proven(sender(number))
    assert door.let_in(1, tries=1) == 1
    door.gate.mark_proven(sender(4))
    assert door.gate.proven_senders == 3
    assert [door.let_in(number, tries=1) for number in (1, 2, 3, 4)] == [1, 0, 1, 1]


@pytest.mark.parametrize(
    ("data", "passes"),
    [
        (bytes([0x40, 1, 0, 1]), True),  # CON GET
        (bytes([0x52, 2, 0, 1, 7, 7]), True),  # NON POST with a token
        (bytes([0x40, 0, 0, 1]), True),  # ping
        (bytes([0x60, 0, 0, 1]), True),  # ACK
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
