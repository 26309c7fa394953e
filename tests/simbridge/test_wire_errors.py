"""Noise, error counters and bus-off, to the bit; a bit is a microsecond."""

import itertools

import can
import pytest

from simbridge.wire.disturbance import BusNoise
from simbridge.wire.end import WireInterface
from simbridge.wire.error_counters import ErrorCounters, ErrorState
from simbridge.wire.error_frames import restarted_frame, state_frame
from simbridge.wire.wire import Wire
from tests.simbridge.wires import (
    BY_IDENTIFIER,
    FIFO,
    MAILBOX,
    US,
    Bursts,
    confirmations,
    ends_on,
    error_frames,
    frame,
    others_frames,
    quiet_wire,
    settings,
    stamp_us,
    waiting,
)

CONTROL = "0002000000000001"  # 122 bits
OTHER_CONTROL = "0002001400140001"

# Classes and controller status of linux/can/error.h.
CRTL, BUS_OFF, RESTARTED, WITH_COUNTERS = 0x004, 0x040, 0x100, 0x200
RX_WARNING, TX_WARNING, RX_PASSIVE, TX_PASSIVE, ACTIVE = 0x04, 0x08, 0x10, 0x20, 0x40


def noisy_wire(*bursts_us: tuple[int, int]) -> Wire:
    bursts: Bursts = tuple((begin * US, end * US) for begin, end in bursts_us)
    return Wire(settings(bursts_s=bursts), seed=1)


def told(message: can.Message) -> tuple[int, int, int, int, int]:
    """When, class, status, transmit and receive counter of an error frame."""
    assert message.is_error_frame
    assert not message.is_extended_id
    assert message.arbitration_id & WITH_COUNTERS
    data = message.data
    return stamp_us(message), message.arbitration_id & ~WITH_COUNTERS, data[1], data[6], data[7]


def test_a_destroyed_frame_is_sent_again() -> None:
    """Noise at bit 50: 51 bits are out, the error frame takes 20, the space 3; then the frame with its 122."""
    wire = noisy_wire((50, 60))
    sender, listener = ends_on(wire, 2)
    sender.send(frame(0x01, CONTROL))
    wire.advance(0.01)
    assert [stamp_us(message) for message in confirmations(sender)] == [51 + 20 + 3 + 122]
    (heard,) = waiting(listener)
    assert heard.data == bytes.fromhex(CONTROL)
    assert (wire.counts.carried, wire.counts.destroyed) == (1, 1)


def test_a_frame_that_noise_just_misses_goes_through() -> None:
    wire = noisy_wire((122, 130))
    sender, listener = ends_on(wire, 2)
    sender.send(frame(0x01, CONTROL))
    wire.advance(0.01)
    assert [stamp_us(message) for message in waiting(listener)] == [122]


def test_a_better_frame_that_came_meanwhile_goes_ahead_of_the_one_that_was_destroyed() -> None:
    wire = noisy_wire((50, 60))
    one, other, listener = ends_on(wire, 3)
    one.send(frame(0x09))
    wire.advance(30 * US)
    other.send(frame(0x01))
    wire.advance(0.01)
    assert [message.arbitration_id for message in waiting(listener)] == [0x01, 0x09]


def test_a_node_puts_a_destroyed_frame_back_where_it_was() -> None:
    for node in (FIFO, BY_IDENTIFIER):
        wire = noisy_wire((50, 60))
        sender, listener = ends_on(wire, 2, node)
        for number in range(3):
            sender.send(frame(0x09, f"{number:016x}"))
        wire.advance(0.01)
        assert [message.data[7] for message in waiting(listener)] == [0, 1, 2]


def test_a_destroyed_frame_gives_way_to_a_newer_one_in_its_mailbox() -> None:
    wire = noisy_wire((50, 60))
    sender, listener = ends_on(wire, 2, MAILBOX)
    sender.send(frame(0x09, f"{1:016x}"))
    wire.advance(30 * US)
    sender.send(frame(0x09, f"{2:016x}"))
    wire.advance(0.01)
    assert [message.data[7] for message in waiting(listener)] == [2]


def test_lasting_noise_takes_a_sender_off_the_bus_and_it_says_so() -> None:
    """Each try costs 1 bit, an error frame of 20 and a space of 3, from error-passive on another 8 of suspension.

    Each counts 8: the twelfth makes 96 (warning), the sixteenth 128 (passive), the 32nd 256 (bus-off).
    """
    wire = noisy_wire((0, 5000))
    sender, listener = ends_on(wire, 2, BY_IDENTIFIER)
    sender.send(frame(0x01, CONTROL))
    wire.advance(1.0)
    assert [told(message) for message in error_frames(sender)] == [
        (11 * 24 + 21, CRTL, TX_WARNING, 96, 0),
        (15 * 24 + 21, CRTL, TX_PASSIVE, 128, 0),
        (16 * 24 + 8 + 15 * 32 + 21, BUS_OFF, 0, 255, 0),
    ]
    assert waiting(listener) == []
    assert wire.counts.destroyed == 32
    sender.send(frame(0x01, CONTROL))
    wire.advance(2.0)
    assert waiting(listener) == waiting(sender) == []


def test_a_node_that_restarts_takes_part_again_after_128_times_11_bits() -> None:
    wire = noisy_wire((0, 5000))
    sender, listener = ends_on(wire, 2)
    sender.send(frame(0x01, CONTROL))
    wire.advance(0.1)
    off_us = 893
    assert [stamp_us(message) for message in error_frames(sender)] == [285, 381, off_us]
    sender.send(frame(0x01, CONTROL))  # no carrier: lost without a word, as on Linux
    wire.advance(off_us * US + 0.1)
    assert [told(message) for message in waiting(sender)] == [(off_us + 100_000, RESTARTED, 0, 0, 0)]
    listener.send(frame(0x09))
    sender.send(frame(0x01, OTHER_CONTROL))
    wire.advance(0.2)
    back_us = off_us + 100_000 + 128 * 11
    # Nothing of what was sent before bus-off or while it lasted comes out.
    (heard,) = others_frames(listener)
    assert heard.data == bytes.fromhex(OTHER_CONTROL)
    assert back_us < stamp_us(heard) < back_us + 140 + 140  # a try of the other one was on the wire
    # The other node had nobody to answer it until then, so it tried again and again.
    assert [message.arbitration_id for message in others_frames(sender)] == [0x09]


def test_a_node_alone_is_not_answered_and_sends_again_for_ever_but_is_not_taken_off() -> None:
    """Up to the ACK slot a CONTROL has 114 bits; then the error frame, the space, and soon the suspension."""
    wire = quiet_wire()
    (sender,) = ends_on(wire, 1)
    sender.send(frame(0x01, CONTROL))
    wire.advance(1.0)
    assert [told(message) for message in waiting(sender)] == [
        (11 * 137 + 134, CRTL, TX_WARNING, 96, 0),
        (15 * 137 + 134, CRTL, TX_PASSIVE, 128, 0),
    ]
    assert wire.counts.destroyed == pytest.approx(1_000_000 / 145, rel=0.01)
    for _ in range(64):
        sender.send(frame(0x01, CONTROL))
    with pytest.raises(can.CanOperationError, match="transmit queue is full"):
        sender.send(frame(0x01, CONTROL))
    (late,) = ends_on(wire, 1)
    wire.advance(1.1)
    assert len(others_frames(late)) == 1 + 64  # one was on the wire
    assert [told(message)[1:4] for message in error_frames(sender)] == [(CRTL, TX_WARNING, 127), (CRTL, ACTIVE, 95)]


def test_an_error_passive_sender_lets_others_go_first() -> None:
    wire = noisy_wire((0, 16 * 24))
    passive, healthy, listener = ends_on(wire, 3)
    passive.send(frame(0x01, CONTROL))
    wire.advance(16 * 24 * US)
    assert told(error_frames(passive)[-1])[2] == TX_PASSIVE
    healthy.send(frame(0x18))
    wire.advance(0.01)
    assert [message.arbitration_id for message in waiting(listener)] == [0x18, 0x01]


def test_two_senders_of_one_identifier_destroy_each_other_until_both_are_off() -> None:
    wire = quiet_wire()
    one, other, listener = ends_on(wire, 3, BY_IDENTIFIER)
    one.send(frame(0x01, CONTROL))
    other.send(frame(0x01, OTHER_CONTROL))
    wire.advance(1.0)
    assert [told(each)[1] for each in error_frames(one)] == [CRTL, CRTL, BUS_OFF]
    assert [told(each)[1] for each in error_frames(other)] == [CRTL, CRTL, BUS_OFF]
    assert others_frames(listener) == []


def test_two_senders_that_agree_bit_for_bit_send_one_frame() -> None:
    wire = quiet_wire()
    one, other, listener = ends_on(wire, 3)
    one.send(frame(0x01, CONTROL))
    other.send(frame(0x01, CONTROL))
    wire.advance(0.01)
    assert len(waiting(listener)) == len(confirmations(one)) == len(confirmations(other)) == 1


def test_a_destroyed_share_is_sent_again_and_nothing_is_missing() -> None:
    wire = Wire(settings(destroyed=0.05), seed=3)
    sender, listener = ends_on(wire, 2)
    for number in range(2000):
        sender.send(frame(0x09, f"{number:016x}"))
        wire.advance((number + 1) * 0.001)
    wire.advance(3.0)
    assert [int.from_bytes(message.data, "big") for message in waiting(listener)] == list(range(2000))
    assert 75 < wire.counts.destroyed < 140
    assert error_frames(sender) == []


def test_bursts_of_chance_come_as_often_and_last_as_long_as_they_are_set_to() -> None:
    noise = BusNoise(settings(gap_s=0.01, length_s=0.002).noise, seed=5)
    step_ns, steps = 50_000, 400_000
    noisy = [noise.corrupted_at_ns(at * step_ns, at * step_ns + 1) is not None for at in range(steps)]
    bursts = sum(now and not before for before, now in itertools.pairwise(noisy))
    seconds = steps * step_ns / 1e9
    assert bursts == pytest.approx(seconds / 0.012, rel=0.1)
    assert sum(noisy) / steps == pytest.approx(0.002 / 0.012, rel=0.1)


def test_the_same_seed_gives_the_same_errors() -> None:
    def run(seed: int) -> list[float]:
        wire = Wire(settings(destroyed=0.2, missed=0.2, gap_s=0.01, length_s=0.001), seed)
        sender, listener = ends_on(wire, 2)
        for number in range(300):
            sender.send(frame(0x09))
            wire.advance((number + 1) * 0.001)
        return [message.timestamp for message in waiting(listener)]

    assert run(1) == run(1)
    assert run(1) != run(2)


def missed_of(wire: Wire, frame_id: int, frames: int = 2000) -> int:
    sender, listener = ends_on(wire, 2)
    for _ in range(frames):
        sender.send(frame(frame_id))
        wire.advance(wire.now_s() + 0.001)
        assert sender.recv(0) is not None  # carried, all of them
    heard = len(waiting(listener))
    sender.shutdown()
    listener.shutdown()
    return frames - heard


def test_a_receiver_misses_the_share_of_each_identifier() -> None:
    wire = Wire(settings(missed=0.1, missed_by_id=((0x09, 0.5), (0x0A, 0.0))), seed=7)
    assert 150 < missed_of(wire, 0x05) < 250
    assert 900 < missed_of(wire, 0x09) < 1100
    assert missed_of(wire, 0x0A) == 0


def test_each_receiver_misses_on_its_own() -> None:
    wire = Wire(settings(missed=0.5), seed=7)
    sender, one, other = ends_on(wire, 3)
    for number in range(60):
        sender.send(frame(0x09, f"{number:016x}"))
    wire.advance(0.1)
    heard = [{message.data[7] for message in waiting(end)} for end in (one, other)]
    assert heard[0] - heard[1]
    assert heard[1] - heard[0]


def test_counters_follow_the_rules_of_can() -> None:
    counters = ErrorCounters()
    counters.sent()
    counters.received()
    assert (counters.transmit, counters.receive, counters.state) == (0, 0, ErrorState.ACTIVE)
    for _ in range(95):
        counters.receive_failed()
    assert counters.state is ErrorState.ACTIVE
    counters.receive_failed()
    assert (counters.receive, counters.state) == (96, ErrorState.WARNING)
    for _ in range(32):
        counters.receive_failed()
    assert (counters.receive, counters.state) == (128, ErrorState.PASSIVE)
    for _ in range(500):
        counters.receive_failed()
    assert (counters.receive, counters.state) == (255, ErrorState.PASSIVE)  # reception takes no node off
    counters.received()
    assert (counters.receive, counters.state) == (119, ErrorState.WARNING)
    for _ in range(31):
        counters.send_failed(unacknowledged=False)
    assert (counters.transmit, counters.state) == (248, ErrorState.PASSIVE)
    counters.send_failed(unacknowledged=True)
    assert (counters.transmit, counters.state) == (248, ErrorState.PASSIVE)
    counters.send_failed(unacknowledged=False)
    assert (counters.transmit, counters.state) == (256, ErrorState.BUS_OFF)


@pytest.mark.parametrize(
    ("transmit", "receive", "error_class", "status"),
    [
        (96, 0, CRTL, TX_WARNING),
        (0, 96, CRTL, RX_WARNING),
        (128, 96, CRTL, TX_PASSIVE),
        (96, 128, CRTL, RX_PASSIVE),
        (130, 129, CRTL, TX_PASSIVE | RX_PASSIVE),
        (95, 95, CRTL, ACTIVE),
        (256, 0, BUS_OFF, 0),
    ],
)
def test_a_state_is_told_as_linux_tells_it(transmit: int, receive: int, error_class: int, status: int) -> None:
    counters = ErrorCounters()
    counters.transmit, counters.receive = transmit, receive
    message = state_frame(counters, 1.5)
    assert told(message) == (1_500_000, error_class, status, min(255, transmit), receive)
    assert told(restarted_frame(ErrorCounters(), 2.0)) == (2_000_000, RESTARTED, 0, 0, 0)
    assert (message.dlc, message.is_rx) == (8, True)


def test_an_end_that_is_unplugged_finishes_its_frame_and_takes_what_it_had_queued_along() -> None:
    wire = quiet_wire()
    leaving, listener = ends_on(wire, 2)
    leaving.send(frame(0x01, CONTROL))
    leaving.send(frame(0x01, OTHER_CONTROL))
    wire.advance(50 * US)
    leaving.shutdown()
    leaving.shutdown()
    wire.advance(0.01)
    assert [message.data for message in waiting(listener)] == [bytes.fromhex(CONTROL)]
    listener.send(frame(0x09))
    wire.advance(0.02)
    assert confirmations(listener) == []  # nobody is left to answer it


def test_an_end_that_is_unplugged_while_its_frame_is_destroyed_does_not_try_again() -> None:
    wire = quiet_wire()
    (leaving,) = ends_on(wire, 1)
    leaving.send(frame(0x01, CONTROL))
    wire.advance(50 * US)
    leaving.shutdown()
    wire.advance(1.0)
    assert wire.counts.destroyed == 1
    late = WireInterface(wire, FIFO)
    wire.advance(2.0)
    assert waiting(late) == []
