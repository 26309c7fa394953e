"""Conformance suite of all kinds of bus. Each kind inherits it and implements how to join."""

import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import Enum, auto
from typing import ClassVar

import can
import pytest

from hal.bus import CONTROL_ID, BusError, CanBus
from hal.control import encode_brake
from hal.frame import Frame
from tests.hal.helpers import CODEC, cycle, pull_the_plug, send

Join = Callable[[], CanBus]
Ends = tuple[CanBus, CanBus]

BUS_OFF = can.Message(arbitration_id=0x040, is_extended_id=False, is_error_frame=True, dlc=8, data=bytes(8))
"""Error frame of a controller that went bus-off, in the layout of Linux."""
RESTARTED = can.Message(arbitration_id=0x100, is_extended_id=False, is_error_frame=True, dlc=8, data=bytes(8))
EXTENDED = can.Message(arbitration_id=0x1234_5678, is_extended_id=True, data=b"\x01\x02\x03")
REMOTE = can.Message(arbitration_id=0x20, is_extended_id=False, is_remote_frame=True, dlc=5)

_NUMBER = struct.Struct(">I")
_NUMBERED_ID = 0x123


class Behind(Enum):
    """Fate of frames for an end that does not read."""

    SENDER_IS_TOLD = auto()
    OLDEST_ARE_LOST = auto()
    NEWEST_ARE_LOST = auto()


@contextmanager
def joining(open_end: Callable[[], CanBus]) -> Iterator[Join]:
    """Join a bus as often as asked, and leave it with every end."""
    ends: list[CanBus] = []

    def join() -> CanBus:
        ends.append(open_end())
        return ends[-1]

    try:
        yield join
    finally:
        for end in ends:
            end.shutdown()


def numbered(number: int) -> Frame:
    return Frame(_NUMBERED_ID, _NUMBER.pack(number))


def numbers(frames: list[can.Message]) -> list[int]:
    return [_NUMBER.unpack(frame.data)[0] for frame in frames]


def identity(frame: can.Message) -> tuple[object, ...]:
    """All that a receiver can tell about what was sent."""
    return (
        frame.arbitration_id,
        frame.is_extended_id,
        frame.is_remote_frame,
        frame.is_error_frame,
        frame.dlc,
        bytes(frame.data),
    )


class BusConformance:
    """The behaviours of all kinds; `ends` are the robot's end and the controller's."""

    receives_own_frames: ClassVar[bool] = False
    """True if an end receives its own CONTROL frames."""
    behind: ClassVar[Behind] = Behind.SENDER_IS_TOLD
    too_many_frames: ClassVar[int] = 10_000
    """More than wait for a listener."""

    @pytest.fixture
    def join(self) -> Iterator[Join]:
        """Open one more end of a bus of its own."""
        raise NotImplementedError

    @pytest.fixture
    def ends(self, join: Join) -> Ends:
        return join(), join()

    def carry(self) -> None:
        """Let the bus carry what was sent; most need no time for it."""

    def heard(self, end: CanBus) -> list[can.Message]:
        """All that an end has to hear by now."""
        self.carry()
        return end.drain()

    def test_frames_arrive_once_in_order_at_all_other_ends(self, ends: Ends) -> None:
        robot_end, far_end = ends
        send(far_end, map(numbered, range(150)))
        assert numbers(self.heard(robot_end)) == list(range(150))
        assert self.heard(robot_end) == []
        assert self.heard(far_end) == []

    def test_an_empty_bus_is_silent(self, ends: Ends) -> None:
        assert [self.heard(end) for end in ends] == [[], []]

    def test_every_listener_hears_every_frame_in_one_order(self, join: Join) -> None:
        robot_end, far_end, one, other = (join() for _ in range(4))
        for number in range(0, 100, 2):
            send(far_end, [numbered(number)])
            self.carry()
            send(robot_end, [numbered(number + 1)])
            self.carry()
        assert numbers(self.heard(one)) == numbers(self.heard(other)) == list(range(100))
        assert numbers(self.heard(robot_end)) == list(range(0, 100, 2))
        assert numbers(self.heard(far_end)) == list(range(1, 100, 2))

    def test_late_end_receives_only_later_frames(self, ends: Ends, join: Join) -> None:
        robot_end, far_end = ends
        send(far_end, [numbered(1)])
        self.heard(robot_end)
        late = join()
        send(far_end, [numbered(2)])
        assert numbers(self.heard(late)) == [2]

    def test_robot_and_controller_exchange_frames_both_ways(self, ends: Ends) -> None:
        robot_end, far_end = ends
        control = robot_end.control_port()
        for counts in range(5):
            control.send(encode_brake())
            send(far_end, cycle(counts))
            assert [identity(frame) for frame in self.heard(robot_end)] == [identity(frame) for frame in cycle(counts)]
            assert [identity(frame) for frame in self.heard(far_end)] == [identity(encode_brake())]

    @pytest.mark.parametrize("length", [0, 3, 8])
    def test_a_payload_of_any_length_arrives_whole(self, ends: Ends, length: int) -> None:
        robot_end, far_end = ends
        sent = Frame(0x7FF, bytes(range(0xF0, 0xF0 + length)))
        send(far_end, [sent])
        (arrived,) = self.heard(robot_end)
        assert identity(arrived) == identity(sent)
        assert arrived.dlc == length

    @pytest.mark.parametrize(
        "sent", [EXTENDED, REMOTE, can.Message(arbitration_id=CONTROL_ID, is_extended_id=True, data=b"12")]
    )
    def test_frames_of_other_formats_arrive_as_what_they_are(self, ends: Ends, sent: can.Message) -> None:
        robot_end, far_end = ends
        send(far_end, [sent])
        (arrived,) = self.heard(robot_end)
        assert identity(arrived) == identity(sent)
        assert arrived.is_rx

    @pytest.mark.parametrize(
        "sent",
        [
            can.Message(arbitration_id=0x09, is_extended_id=False, data=bytes(9)),
            can.Message(arbitration_id=0x09, is_extended_id=False, is_fd=True, data=bytes(8)),
            can.Message(arbitration_id=0x09, is_extended_id=False, is_remote_frame=True, dlc=9),
        ],
    )
    def test_frame_that_is_not_classic_can_is_refused(self, ends: Ends, sent: can.Message) -> None:
        robot_end, far_end = ends
        with pytest.raises(ValueError, match=r"0x9 .*classic"):
            send(far_end, [sent])
        assert self.heard(robot_end) == []

    def test_only_what_is_listened_to_arrives_and_control_always(self, ends: Ends) -> None:
        robot_end, far_end = ends
        robot_end.set_id_filter({0x09, 0x20})
        far_end.control_port().send(encode_brake())
        send(far_end, [Frame(0x08, b""), Frame(0x09, b"a"), EXTENDED, Frame(0x20, b"b"), Frame(0x21, b"")])
        send(far_end, [can.Message(arbitration_id=0x09, is_extended_id=True, data=b"c")])
        send(far_end, [can.Message(arbitration_id=0x809, is_extended_id=True, data=b"d")])
        assert [identity(frame)[0] for frame in self.heard(robot_end)] == [CONTROL_ID, 0x09, 0x20]
        robot_end.set_id_filter({0x08})
        send(far_end, [Frame(0x08, b"e"), Frame(0x09, b"f")])
        assert [bytes(frame.data) for frame in self.heard(robot_end)] == [b"e"]

    def test_listening_to_nothing_is_not_listening_to_all(self, ends: Ends) -> None:
        robot_end, far_end = ends
        robot_end.set_id_filter(())
        far_end.control_port().send(encode_brake())
        send(far_end, cycle())
        assert [frame.arbitration_id for frame in self.heard(robot_end)] == [CONTROL_ID]

    def test_waiting_frames_pass_a_new_filter_too(self, ends: Ends, join: Join) -> None:
        robot_end, far_end = ends
        watcher = join()
        send(far_end, [Frame(0x08, b""), Frame(0x09, b"")])
        assert len(self.heard(watcher)) == 2
        robot_end.set_id_filter({0x09})
        assert [frame.arbitration_id for frame in self.heard(robot_end)] == [0x09]

    def test_only_the_control_port_carries_control_and_nothing_else(self, ends: Ends) -> None:
        robot_end, far_end = ends
        with pytest.raises(ValueError, match="0x1 refused"):
            robot_end.telemetry_port().send(encode_brake())
        control = robot_end.control_port()
        with pytest.raises(ValueError, match="0x9 refused"):
            control.send(CODEC.message("ENCODER").pack(0, 0))
        with pytest.raises(BusError, match="taken"):
            robot_end.control_port()
        assert self.heard(far_end) == []
        control.send(encode_brake())
        assert [frame.arbitration_id for frame in self.heard(far_end)] == [CONTROL_ID]

    @pytest.mark.parametrize(("frame_id", "is_extended"), [(0x801, False), (0x4000_0001, True), (-0x7FF, False)])
    def test_control_is_not_smuggled_out_by_a_wide_identifier(
        self, ends: Ends, frame_id: int, is_extended: bool
    ) -> None:
        robot_end, far_end = ends
        smuggled = can.Message(arbitration_id=frame_id, is_extended_id=is_extended, data=encode_brake().data)
        with pytest.raises(ValueError, match=f"0x{frame_id:X} "):
            robot_end.telemetry_port().send(smuggled)
        assert self.heard(far_end) == []

    def test_own_control_waits_until_it_was_carried(self, ends: Ends) -> None:
        robot_end, far_end = ends
        robot_end.set_id_filter({0x09})  # the confirmation comes all the same
        control = robot_end.control_port()
        for waiting in (1, 2, 3):
            control.send(encode_brake())
            assert control.unconfirmed == (waiting if self.receives_own_frames else 0)
        send(robot_end, [numbered(1), can.Message(arbitration_id=CONTROL_ID, is_extended_id=True, data=b"")])
        assert self.heard(robot_end) == []
        assert control.unconfirmed == 0
        assert len(self.heard(far_end)) == 5

    def test_control_of_somebody_else_is_heard_and_confirms_nothing(self, ends: Ends) -> None:
        robot_end, far_end = ends
        control = robot_end.control_port()
        far_end.control_port().send(encode_brake())
        self.carry()
        control.send(encode_brake())
        heard = self.heard(robot_end)
        assert [(frame.arbitration_id, frame.is_rx) for frame in heard] == [(CONTROL_ID, True)]
        assert control.unconfirmed == 0
        assert [frame.arbitration_id for frame in self.heard(far_end)] == [CONTROL_ID]

    def test_a_frame_is_no_older_than_its_sending(self, ends: Ends) -> None:
        robot_end, far_end = ends
        if robot_end.now_s() is None:  # all that waits has just arrived
            return
        before_s = robot_end.now_s()
        for number in range(3):
            send(far_end, [numbered(number)])
            frames = self.heard(robot_end)
            after_s = robot_end.now_s()
            assert before_s is not None
            assert after_s is not None
            assert [number] == numbers(frames)
            assert before_s <= frames[0].timestamp <= after_s
            before_s = frames[0].timestamp

    def test_an_end_that_was_shut_down_says_so_and_the_others_go_on(self, ends: Ends, join: Join) -> None:
        robot_end, far_end = ends
        other = join()
        port = robot_end.telemetry_port()
        robot_end.shutdown()
        robot_end.shutdown()
        with pytest.raises(BusError, match=f"{robot_end.name}: .*shut down"):
            robot_end.drain()
        with pytest.raises(BusError, match="shut down"):
            port.send(numbered(0))
        with pytest.raises(BusError, match="shut down"):
            robot_end.set_id_filter({0x09})
        send(far_end, [numbered(1)])
        assert numbers(self.heard(other)) == [1]

    def test_reopened_end_keeps_filter_and_ports(self, ends: Ends) -> None:
        robot_end, far_end = ends
        port, control = robot_end.telemetry_port(), robot_end.control_port()
        robot_end.set_id_filter({0x09})
        control.send(encode_brake())
        robot_end.reopen()
        assert control.unconfirmed == 0
        self.heard(far_end)
        port.send(numbered(1))
        control.send(encode_brake())
        send(far_end, [Frame(0x08, b""), Frame(0x09, b"x")])
        assert [bytes(frame.data) for frame in self.heard(robot_end)] == [b"x"]
        assert [frame.arbitration_id for frame in self.heard(far_end)] == [_NUMBERED_ID, CONTROL_ID]

    def test_lost_bus_raises_one_line_until_reopened(self, ends: Ends) -> None:
        robot_end, far_end = ends
        pull_the_plug(robot_end)
        for _ in range(2):
            with pytest.raises(BusError, match=f"{robot_end.name}: receiving"):
                robot_end.drain()
            with pytest.raises(BusError, match=f"{robot_end.name}: sending"):
                send(robot_end, [numbered(0)])
        robot_end.reopen()
        send(far_end, [numbered(1)])
        assert numbers(self.heard(robot_end)) == [1]

    def test_frames_for_a_listener_that_takes_none(self, ends: Ends) -> None:
        robot_end, far_end = ends
        robot_end.set_id_filter({_NUMBERED_ID})
        port = far_end.telemetry_port()
        sent = 0
        try:
            while sent < self.too_many_frames:
                port.send(numbered(sent))
                self.carry()
                sent += 1
        except BusError:
            assert self.behind is Behind.SENDER_IS_TOLD
        else:
            assert self.behind is not Behind.SENDER_IS_TOLD
        heard: list[int] = []
        while arrived := numbers(self.heard(robot_end)):
            heard += arrived
        assert heard
        port.send(numbered(sent))
        assert numbers(self.heard(robot_end)) == [sent]  # it goes on as if nothing had been
        lost = sent - len(heard)
        assert robot_end.overruns == lost
        assert (lost == 0) is (self.behind is Behind.SENDER_IS_TOLD)
        first = lost if self.behind is Behind.OLDEST_ARE_LOST else 0
        assert heard == list(range(first, first + len(heard)))


class ErrorFrameConformance(BusConformance):
    """The behaviours of kinds on which an error frame can be sent for what a controller would report by itself."""

    @pytest.mark.parametrize("sent", [BUS_OFF, RESTARTED])
    def test_error_frames_arrive_as_what_they_are(self, ends: Ends, sent: can.Message) -> None:
        robot_end, far_end = ends
        send(far_end, [sent])
        (arrived,) = self.heard(robot_end)
        assert identity(arrived) == identity(sent)
        assert arrived.is_rx

    def test_error_frames_pass_every_filter(self, ends: Ends) -> None:
        robot_end, far_end = ends
        robot_end.set_id_filter(())
        send(far_end, [*cycle(), BUS_OFF, *cycle(), RESTARTED])
        assert [identity(frame) for frame in self.heard(robot_end)] == [identity(BUS_OFF), identity(RESTARTED)]
