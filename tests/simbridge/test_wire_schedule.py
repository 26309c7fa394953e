"""When each frame is there, to the bit, against a schedule worked out by hand."""

from simbridge.wire.end import WireInterface
from simbridge.wire.wire import Wire
from tests.simbridge.wires import (
    BY_IDENTIFIER,
    FIFO,
    MAILBOX,
    US,
    confirmations,
    ends_on,
    frame,
    others_frames,
    quiet_wire,
    settings,
    stamp_us,
    waiting,
)

ADC = "00C800C800C800C8"
NOUGHT = "0000000000000000"
FIRST_CONTROLLER = {
    0x04: "00A7000100000000",
    0x05: ADC,
    0x06: ADC,
    0x07: ADC,
    0x08: "0096009600000018",
    0x09: NOUGHT,
    0x0A: NOUGHT,
    0x0B: NOUGHT,
    0x0C: NOUGHT,
    0x0D: "8000800000000000",
    0x0E: NOUGHT,
}
SECOND_CONTROLLER = {0x14: "00A7000100000000", 0x15: ADC, 0x16: ADC, 0x17: ADC, 0x18: ADC}
CONTROL = "0002000000000001"

# Sixteen frames of telemetry, queued at 0 by two controllers; CONTROL queued by the notebook at 300 us. A bit is a
# microsecond. Bits as can-utils counts them (canframelen, mode exact), from the start bit to the end of frame; the next
# frame begins three bits later. The best identifier of those that wait goes: CONTROL as soon as the frame is out that
# is on the wire at 300 us, then the first controller, then the second one.
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


def test_the_schedule_adds_up() -> None:
    free_us = 0
    for _, begins_us, bits, ends_us in SCHEDULE:
        assert begins_us == free_us
        assert ends_us == begins_us + bits
        free_us = ends_us + 3


def test_sixteen_frames_of_two_controllers_and_control_go_by_the_schedule() -> None:
    wire = quiet_wire()
    first, second, notebook, listener = ends_on(wire, 4)
    for end, frames in ((first, FIRST_CONTROLLER), (second, SECOND_CONTROLLER)):
        for frame_id, payload in frames.items():
            end.send(frame(frame_id, payload))
    wire.advance(300 * US)
    notebook.send(frame(0x01, CONTROL))
    wire.advance(0.01)
    heard = waiting(listener)
    assert [(message.arbitration_id, stamp_us(message)) for message in heard] == [
        (frame_id, ends_us) for frame_id, _, _, ends_us in SCHEDULE
    ]
    # CONTROL was on its way for 188 us, and the notebook knows it at the same moment.
    assert [stamp_us(message) - 300 for message in confirmations(notebook)] == [188]
    assert wire.counts.busy_ns == 2_093_000


def test_a_frame_is_there_when_its_last_bit_is_and_not_before() -> None:
    wire = quiet_wire()
    robot, notebook = ends_on(wire, 2)
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


def test_nothing_interrupts_a_frame_on_the_wire() -> None:
    wire = quiet_wire()
    one, other, listener = ends_on(wire, 3)
    one.send(frame(0x7FF))
    wire.advance(1 * US)
    other.send(frame(0x000))
    wire.advance(0.01)
    assert [message.arbitration_id for message in waiting(listener)] == [0x7FF, 0x000]


def test_what_is_queued_at_the_moment_at_which_the_wire_is_free_takes_part() -> None:
    wire = quiet_wire()
    one, other, listener = ends_on(wire, 3)
    one.send(frame(0x04, "00A7000100000000"))
    one.send(frame(0x05, ADC))
    wire.advance(124 * US)
    other.send(frame(0x01, CONTROL))
    wire.advance(0.01)
    assert [message.arbitration_id for message in waiting(listener)] == [0x04, 0x01, 0x05]


def order_of(sender: WireInterface, wire: Wire, listener: WireInterface) -> list[int]:
    for frame_id in (0x18, 0x0A, 0x01):
        sender.send(frame(frame_id))
    wire.advance(0.01)
    return [message.arbitration_id for message in others_frames(listener)]


def test_a_node_sends_in_the_order_in_which_it_was_told_and_its_worst_frame_holds_up_its_best() -> None:
    wire = quiet_wire()
    sender, listener, rival = ends_on(wire, 3, FIFO)
    rival.send(frame(0x10))
    assert order_of(sender, wire, listener) == [0x10, 0x18, 0x0A, 0x01]


def test_a_node_that_sends_its_best_first_holds_nothing_up() -> None:
    wire = quiet_wire()
    sender, listener, rival = ends_on(wire, 3, BY_IDENTIFIER)
    rival.send(frame(0x10))
    assert order_of(sender, wire, listener) == [0x01, 0x0A, 0x10, 0x18]


def test_a_mailbox_keeps_the_newest_of_each_identifier_and_is_never_full() -> None:
    wire = quiet_wire()
    sender, listener = ends_on(wire, 2, MAILBOX)
    sender.send(frame(0x09, f"{0:016x}"))
    wire.advance(1 * US)  # that one is on the wire
    for number in range(1, 200):
        sender.send(frame(0x09, f"{number:016x}"))
        sender.send(frame(0x05, f"{number:016x}"))
    wire.advance(0.01)
    assert [(each.arbitration_id, each.data[7]) for each in waiting(listener)] == [(0x09, 0), (0x05, 199), (0x09, 199)]


def test_frames_of_one_identifier_stay_in_order_whichever_way_a_node_sends() -> None:
    for node in (FIFO, BY_IDENTIFIER):
        wire = quiet_wire()
        sender, listener = ends_on(wire, 2, node)
        for number in range(20):
            sender.send(frame(0x09, f"{number:016x}"))
        wire.advance(0.01)
        assert [int.from_bytes(message.data, "big") for message in waiting(listener)] == list(range(20))


def test_a_slower_wire_takes_as_many_times_longer() -> None:
    wire = Wire(settings(bit_rate_bit_s=125_000), seed=1)
    sender, listener = ends_on(wire, 2)
    sender.send(frame(0x01, CONTROL))
    wire.advance(0.01)
    assert [stamp_us(message) for message in waiting(listener)] == [8 * 122]


def test_a_wire_that_follows_a_clock_carries_by_it() -> None:
    times_s = iter([1000.0, 1000.0, 1000.000121, 1000.000122, 1000.0005, 1000.0006])
    wire = quiet_wire()
    sender, listener = ends_on(wire, 2)
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
