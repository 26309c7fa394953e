"""Noise, loss, error counters and bus-off, to the bit; a bit is a microsecond."""

import itertools

import can
import pytest

from simbridge.wire.bus_noise import BusNoise
from simbridge.wire.error_counters import ErrorCounters, ErrorState
from simbridge.wire.error_frames import restarted_frame, state_frame
from simbridge.wire.settings import LossSettings, NodeSettings
from simbridge.wire.wire import Wire
from simbridge.wire.wire_interface import WireInterface
from tests.simbridge.wires import (
    BY_IDENTIFIER,
    CONTROL,
    FIFO,
    MAILBOX,
    NO_NOISE,
    US,
    confirmations,
    ends_on,
    error_frames,
    frame,
    joined,
    new_wire,
    numbered,
    others_frames,
    stamp_us,
    waiting,
    waiting_ids,
    waiting_numbers,
)

OTHER_CONTROL = "0002001400140001"

# Classes and controller status of linux/can/error.h.
CRTL, BUS_OFF, RESTARTED, WITH_COUNTERS = 0x004, 0x040, 0x100, 0x200
RX_WARNING, TX_WARNING, RX_PASSIVE, TX_PASSIVE, ACTIVE = 0x04, 0x08, 0x10, 0x20, 0x40


def noisy_wire(begin_us: int, end_us: int) -> Wire:
    return new_wire(bursts_s=((begin_us * US, end_us * US),))


def told(message: can.Message) -> tuple[int, int, int, int, int]:
    """Return time in us, class, status, transmit and receive counter of an error frame."""
    assert message.is_error_frame
    assert not message.is_extended_id
    assert message.arbitration_id & WITH_COUNTERS
    data = message.data
    return stamp_us(message), message.arbitration_id & ~WITH_COUNTERS, data[1], data[6], data[7]


def test_wire_noise_on_a_frame_sends_it_again() -> None:
    """Noise at bit 50: 51 bits are out, the error frame takes 20, the space 3; then the frame with its 122."""
    wire = noisy_wire(50, 60)
    sender, listener = ends_on(wire, 2)
    sender.send(frame(0x01, CONTROL))
    wire.advance(0.01)
    assert [stamp_us(message) for message in confirmations(sender)] == [51 + 20 + 3 + 122]
    assert [message.data for message in waiting(listener)] == [bytes.fromhex(CONTROL)]
    assert (wire.counts.carried, wire.counts.destroyed) == (1, 1)


def test_wire_noise_after_the_last_bit_is_harmless() -> None:
    wire = noisy_wire(122, 130)
    sender, listener = ends_on(wire, 2)
    sender.send(frame(0x01, CONTROL))
    wire.advance(0.01)
    assert [stamp_us(message) for message in waiting(listener)] == [122]


def test_wire_destroyed_frame_loses_to_a_better_new_one() -> None:
    wire = noisy_wire(50, 60)
    one, other, listener = ends_on(wire, 3)
    one.send(frame(0x09))
    wire.advance(30 * US)
    other.send(frame(0x01))
    wire.advance(0.01)
    assert waiting_ids(listener) == [0x01, 0x09]


@pytest.mark.parametrize("node", [FIFO, BY_IDENTIFIER])
def test_node_destroyed_frame_keeps_its_place(node: NodeSettings) -> None:
    wire = noisy_wire(50, 60)
    sender, listener = ends_on(wire, 2, node)
    for number in range(3):
        sender.send(numbered(0x09, number))
    wire.advance(0.01)
    assert waiting_numbers(listener) == [0, 1, 2]


def test_mailbox_destroyed_frame_is_replaced_by_a_newer_one() -> None:
    wire = noisy_wire(50, 60)
    sender, listener = ends_on(wire, 2, MAILBOX)
    sender.send(numbered(0x09, 1))
    wire.advance(30 * US)
    sender.send(numbered(0x09, 2))
    wire.advance(0.01)
    assert waiting_numbers(listener) == [2]


def test_node_lasting_noise_leads_to_bus_off() -> None:
    """Each try costs 1 bit, an error frame of 20 and a space of 3, from error-passive on another 8 of suspension.

    Each counts 8: the twelfth makes 96 (warning), the sixteenth 128 (passive), the 32nd 256 (bus-off).
    """
    wire = noisy_wire(0, 5000)
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


def test_node_restart_takes_part_after_128_times_11_bits() -> None:
    wire = noisy_wire(0, 5000)
    sender, listener = ends_on(wire, 2)
    sender.send(frame(0x01, CONTROL))
    wire.advance(0.1)
    off_us = 893
    assert [stamp_us(message) for message in error_frames(sender)] == [285, 381, off_us]
    sender.send(frame(0x01, CONTROL))  # dropped: no carrier, as on Linux
    wire.advance(off_us * US + 0.1)
    assert [told(message) for message in waiting(sender)] == [(off_us + 100_000, RESTARTED, 0, 0, 0)]
    listener.send(frame(0x09))
    sender.send(frame(0x01, OTHER_CONTROL))
    wire.advance(0.2)
    back_us = off_us + 100_000 + 128 * 11
    (heard,) = others_frames(listener)  # none of the frames sent before or during bus-off
    assert heard.data == bytes.fromhex(OTHER_CONTROL)
    assert back_us < stamp_us(heard) < back_us + 140 + 140  # one try of the other node was on the wire
    # Without a receiver the other node repeated its frame until then.
    assert [message.arbitration_id for message in others_frames(sender)] == [0x09]


def test_node_alone_repeats_for_ever_without_bus_off() -> None:
    """A CONTROL has 114 bits before the ACK slot; then come the error frame, the space, and soon the suspension."""
    wire, (sender,) = joined(1)
    sender.send(frame(0x01, CONTROL))
    wire.advance(1.0)
    assert [told(message) for message in waiting(sender)] == [
        (11 * 137 + 134, CRTL, TX_WARNING, 96, 0),
        (15 * 137 + 134, CRTL, TX_PASSIVE, 128, 0),
    ]
    assert wire.counts.destroyed == pytest.approx(1_000_000 / 145, rel=0.01)
    for _ in range(64):
        sender.send(frame(0x01, CONTROL))
    with pytest.raises(can.CanOperationError):
        sender.send(frame(0x01, CONTROL))
    (late,) = ends_on(wire, 1)
    wire.advance(1.1)
    assert len(others_frames(late)) == 1 + 64  # one was on the wire
    assert [told(message)[1:4] for message in error_frames(sender)] == [(CRTL, TX_WARNING, 127), (CRTL, ACTIVE, 95)]


def test_node_error_passive_lets_others_go_first() -> None:
    wire = noisy_wire(0, 16 * 24)
    passive, healthy, listener = ends_on(wire, 3)
    passive.send(frame(0x01, CONTROL))
    wire.advance(16 * 24 * US)
    assert told(error_frames(passive)[-1])[2] == TX_PASSIVE
    healthy.send(frame(0x18))
    wire.advance(0.01)
    assert waiting_ids(listener) == [0x18, 0x01]


def test_wire_two_senders_that_disagree_both_go_off() -> None:
    wire, (one, other, listener) = joined(3, BY_IDENTIFIER)
    one.send(frame(0x01, CONTROL))
    other.send(frame(0x01, OTHER_CONTROL))
    wire.advance(1.0)
    for sender in (one, other):
        assert [told(each)[1] for each in error_frames(sender)] == [CRTL, CRTL, BUS_OFF]
    assert others_frames(listener) == []


def test_wire_two_senders_that_agree_send_one_frame() -> None:
    wire, (one, other, listener) = joined(3)
    one.send(frame(0x01, CONTROL))
    other.send(frame(0x01, CONTROL))
    wire.advance(0.01)
    assert len(waiting(listener)) == len(confirmations(one)) == len(confirmations(other)) == 1


def test_wire_random_noise_loses_no_frame() -> None:
    wire = new_wire(seed=3, destroyed_share=0.05)
    sender, listener = ends_on(wire, 2)
    for number in range(2000):
        sender.send(numbered(0x09, number))
        wire.advance((number + 1) * 0.001)
    wire.advance(3.0)
    assert waiting_numbers(listener) == list(range(2000))
    assert 75 < wire.counts.destroyed < 140
    assert error_frames(sender) == []


def test_noise_bursts_have_the_set_gap_and_length() -> None:
    noise = BusNoise(NO_NOISE.model_copy(update={"burst_gap_s": 0.01, "burst_length_s": 0.002}), seed=5)
    step_ns, steps = 50_000, 400_000
    noisy = [noise.corrupted_at_ns(at * step_ns, at * step_ns + 1) is not None for at in range(steps)]
    bursts = sum(now and not before for before, now in itertools.pairwise(noisy))
    assert bursts == pytest.approx(steps * step_ns / 1e9 / 0.012, rel=0.1)
    assert sum(noisy) / steps == pytest.approx(0.002 / 0.012, rel=0.1)


def test_wire_same_seed_gives_the_same_errors() -> None:
    def run(seed: int) -> list[float]:
        loss = LossSettings(share=0.2, shares_by_id=())
        wire = new_wire(seed, loss=loss, destroyed_share=0.2, burst_gap_s=0.01, burst_length_s=0.001)
        sender, listener = ends_on(wire, 2)
        for number in range(300):
            sender.send(frame(0x09))
            wire.advance((number + 1) * 0.001)
        return [message.timestamp for message in waiting(listener)]

    assert run(1) == run(1)
    assert run(1) != run(2)


def dropped(wire: Wire, frame_id: int) -> int:
    """Return how many of 2000 frames the receiver drops."""
    sender, listener = ends_on(wire, 2)
    for _ in range(2000):
        sender.send(frame(frame_id))
        wire.advance(wire.now_s() + 0.001)
        assert sender.recv(0) is not None  # carried, all of them
    lost = 2000 - len(waiting(listener))
    sender.shutdown()
    listener.shutdown()
    return lost


def test_loss_by_identifier_has_the_set_probability() -> None:
    wire = new_wire(seed=7, loss=LossSettings(share=0.1, shares_by_id=((0x09, 0.5), (0x0A, 0.0))))
    assert 150 < dropped(wire, 0x05) < 250
    assert 900 < dropped(wire, 0x09) < 1100
    assert dropped(wire, 0x0A) == 0


def test_loss_at_two_receivers_is_independent() -> None:
    wire = new_wire(seed=7, loss=LossSettings(share=0.5, shares_by_id=()))
    sender, one, other = ends_on(wire, 3)
    for number in range(60):
        sender.send(numbered(0x09, number))
    wire.advance(0.1)
    first, second = set(waiting_numbers(one)), set(waiting_numbers(other))
    assert first - second
    assert second - first


def test_error_counters_follow_the_rules_of_can() -> None:
    counters = ErrorCounters()

    def after(times: int, *, sending: bool = False, unacknowledged: bool = False) -> tuple[int, int, ErrorState]:
        for _ in range(times):
            if sending:
                counters.send_failed(unacknowledged=unacknowledged)
            else:
                counters.receive_failed()
        return counters.transmit, counters.receive, counters.state

    counters.sent()
    counters.received()
    assert after(0) == (0, 0, ErrorState.ACTIVE)
    assert after(95) == (0, 95, ErrorState.ACTIVE)
    assert after(1) == (0, 96, ErrorState.WARNING)
    assert after(32) == (0, 128, ErrorState.PASSIVE)
    assert after(500) == (0, 255, ErrorState.PASSIVE)  # reception takes no node off
    counters.received()
    assert after(0) == (0, 119, ErrorState.WARNING)
    assert after(31, sending=True) == (248, 119, ErrorState.PASSIVE)
    assert after(1, sending=True, unacknowledged=True) == (248, 119, ErrorState.PASSIVE)
    assert after(1, sending=True) == (256, 119, ErrorState.BUS_OFF)


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
def test_error_frame_has_linux_layout(transmit: int, receive: int, error_class: int, status: int) -> None:
    counters = ErrorCounters()
    counters.transmit, counters.receive = transmit, receive
    message = state_frame(counters, 1.5)
    assert told(message) == (1_500_000, error_class, status, min(255, transmit), receive)
    assert told(restarted_frame(ErrorCounters(), 2.0)) == (2_000_000, RESTARTED, 0, 0, 0)
    assert (message.dlc, message.is_rx) == (8, True)


def test_end_unplugged_finishes_only_the_frame_on_the_wire() -> None:
    wire, (leaving, listener) = joined(2)
    leaving.send(frame(0x01, CONTROL))
    leaving.send(frame(0x01, OTHER_CONTROL))
    wire.advance(50 * US)
    leaving.shutdown()
    leaving.shutdown()
    wire.advance(0.01)
    assert [message.data for message in waiting(listener)] == [bytes.fromhex(CONTROL)]
    listener.send(frame(0x09))
    wire.advance(0.02)
    assert confirmations(listener) == []  # no other node acknowledges it


def test_end_unplugged_does_not_repeat_a_destroyed_frame() -> None:
    wire, (leaving,) = joined(1)
    leaving.send(frame(0x01, CONTROL))
    wire.advance(50 * US)
    leaving.shutdown()
    wire.advance(1.0)
    assert wire.counts.destroyed == 1
    late = WireInterface(wire, FIFO)
    wire.advance(2.0)
    assert waiting(late) == []
