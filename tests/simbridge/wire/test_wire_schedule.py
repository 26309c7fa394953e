"""Arrival times of frames, to the bit, against a schedule calculated by hand."""

import pytest

from simbridge.wire.settings import NodeSettings
from tests.simbridge.wires import (
    BY_IDENTIFIER,
    CONTROL,
    FIFO,
    MAILBOX,
    US,
    confirmations,
    ends_on,
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

ADC = "00C800C800C800C8"
ZEROS = "0000000000000000"
FIRST_CONTROLLER = {
    0x04: "00A7000100000000",
    **dict.fromkeys((0x05, 0x06, 0x07), ADC),
    0x08: "0096009600000018",
    **dict.fromkeys((0x09, 0x0A, 0x0B, 0x0C), ZEROS),
    0x0D: "8000800000000000",
    0x0E: ZEROS,
}
SECOND_CONTROLLER = {0x14: "00A7000100000000", **dict.fromkeys((0x15, 0x16, 0x17, 0x18), ADC)}

# Sixteen frames of telemetry, queued at 0 by two controllers; CONTROL queued by the notebook at 300 us. A bit is a
# microsecond. Bits as can-utils counts them (canframelen, mode exact), from the start bit to the end of frame; the next
# frame begins three bits later. The lowest waiting identifier goes first: CONTROL after the frame on the wire at
# 300 us, then the first controller, then the second one.
SCHEDULE = [
    # identifier, begins, bits, ends
    (0x04, 0, 121, 121),
    (0x05, 124, 118, 242),
    (0x06, 245, 118, 363),
    (0x01, 366, 122, 488),
    (0x07, 491, 117, 608),
    (0x08, 611, 120, 731),
    (0x09, 734, 122, 856),
    (0x0A, 859, 122, 981),
    (0x0B, 984, 122, 1106),
    (0x0C, 1109, 124, 1233),
    (0x0D, 1236, 121, 1357),
    (0x0E, 1360, 122, 1482),
    (0x14, 1485, 122, 1607),
    (0x15, 1610, 117, 1727),
    (0x16, 1730, 118, 1848),
    (0x17, 1851, 117, 1968),
    (0x18, 1971, 119, 2090),
]


def test_wire_two_controllers_and_control_keep_the_schedule() -> None:
    wire, (first, second, notebook, listener) = joined(4)
    for end, frames in ((first, FIRST_CONTROLLER), (second, SECOND_CONTROLLER)):
        for frame_id, payload in frames.items():
            end.send(frame(frame_id, payload))
    wire.advance(300 * US)
    notebook.send(frame(0x01, CONTROL))
    wire.advance(0.01)
    assert [(message.arbitration_id, stamp_us(message)) for message in waiting(listener)] == [
        (frame_id, ends_us) for frame_id, _, _, ends_us in SCHEDULE
    ]
    # CONTROL took 188 us, and the notebook gets its confirmation at the same moment.
    assert [stamp_us(message) - 300 for message in confirmations(notebook)] == [188]
    assert wire.counts.busy_ns == 2_093_000


def test_wire_frame_arrives_with_its_last_bit() -> None:
    wire, (robot, notebook) = joined(2)
    notebook.send(frame(0x01, CONTROL))
    assert wire.now_s() == 0.0
    wire.advance(121 * US)
    assert waiting(robot) == waiting(notebook) == []
    wire.advance(122 * US)
    (heard,) = waiting(robot)
    (confirmed,) = waiting(notebook)
    assert (heard.is_rx, confirmed.is_rx) == (True, False)
    assert heard.timestamp == confirmed.timestamp == robot.now_s() == 122 * US
    assert heard.data == confirmed.data == bytes.fromhex(CONTROL)


def test_wire_frame_on_the_wire_is_not_interrupted() -> None:
    wire, (one, other, listener) = joined(3)
    one.send(frame(0x7FF))
    wire.advance(1 * US)
    other.send(frame(0x000))
    wire.advance(0.01)
    assert waiting_ids(listener) == [0x7FF, 0x000]


def test_wire_frame_queued_when_the_wire_is_free_takes_part() -> None:
    wire, (one, other, listener) = joined(3)
    one.send(frame(0x04, "00A7000100000000"))
    one.send(frame(0x05, ADC))
    wire.advance(124 * US)
    other.send(frame(0x01, CONTROL))
    wire.advance(0.01)
    assert waiting_ids(listener) == [0x04, 0x01, 0x05]


@pytest.mark.parametrize(
    ("node", "order"), [(FIFO, [0x10, 0x18, 0x0A, 0x01]), (BY_IDENTIFIER, [0x01, 0x0A, 0x10, 0x18])]
)
def test_node_sends_in_its_order(node: NodeSettings, order: list[int]) -> None:
    wire, (sender, listener, rival) = joined(3, node)
    rival.send(frame(0x10))
    for frame_id in (0x18, 0x0A, 0x01):
        sender.send(frame(frame_id))
    wire.advance(0.01)
    assert [message.arbitration_id for message in others_frames(listener)] == order


def test_mailbox_keeps_the_newest_of_each_identifier() -> None:
    wire, (sender, listener) = joined(2, MAILBOX)
    sender.send(numbered(0x09, 0))
    wire.advance(1 * US)  # that one is on the wire
    for number in range(1, 200):
        sender.send(numbered(0x09, number))
        sender.send(numbered(0x05, number))
    wire.advance(0.01)
    assert [(each.arbitration_id, each.data[7]) for each in waiting(listener)] == [(0x09, 0), (0x05, 199), (0x09, 199)]


@pytest.mark.parametrize("node", [FIFO, BY_IDENTIFIER])
def test_node_keeps_the_order_within_an_identifier(node: NodeSettings) -> None:
    wire, (sender, listener) = joined(2, node)
    for number in range(20):
        sender.send(numbered(0x09, number))
    wire.advance(0.01)
    assert waiting_numbers(listener) == list(range(20))


def test_wire_at_an_eighth_of_the_rate_takes_eight_times() -> None:
    wire = new_wire(bit_rate_bit_s=125_000)
    sender, listener = ends_on(wire, 2)
    sender.send(frame(0x01, CONTROL))
    wire.advance(0.01)
    assert [stamp_us(message) for message in waiting(listener)] == [8 * 122]


def test_wire_with_a_clock_carries_by_it() -> None:
    times_s = iter([1000.0, 1000.0, 1000.000121, 1000.000122, 1000.0005, 1000.0006])
    wire, (sender, listener) = joined(2)
    wire.advance(5.0)
    wire.follow(lambda: next(times_s))
    sender.send(frame(0x01, CONTROL))
    assert listener.recv(0) is None
    heard = listener.recv(0)
    assert heard is not None
    assert stamp_us(heard) == 5_000_122
    assert round(wire.now_s(), 6) == 5.0005
    wire.follow(None)
    assert round(wire.now_s(), 6) == 5.0006
