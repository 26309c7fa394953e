"""The bus in this process behaves as a bus should, and says one clear line when there is none."""

import copy
from pathlib import Path

import can
import pytest

from hal.bus import BusError, CanBus, open_bus
from hal.control import encode_brake
from hal.frame import Frame
from tests.hal.helpers import CODEC, bus_pair, cycle, pull_the_plug, send

Ends = tuple[CanBus, CanBus]


def test_frames_arrive_once_in_order_and_never_wait(ends: Ends) -> None:
    robot_end, far_end = ends
    port = far_end.telemetry_port()
    for ticks in range(300):
        port.send(CODEC.message("ENCODER").pack(ticks, 0))
    arrived = [CODEC.message("ENCODER").unpack(message.data)[0] for message in robot_end.drain()]
    assert arrived == list(range(300))
    assert robot_end.drain() == []
    assert far_end.drain() == []


def test_every_listener_gets_a_frame_of_its_own_with_the_payload_shared(ends: Ends) -> None:
    robot_end, far_end = ends
    listener = open_bus(robot_end.name)
    frame = cycle()[0]
    far_end.telemetry_port().send(frame)
    (first,), (second,) = robot_end.drain(), listener.drain()
    listener.shutdown()
    assert first is not second
    assert first is not frame
    assert isinstance(first, Frame)
    assert first.data is second.data is frame.data
    assert first.equals(second, timestamp_delta=None)
    assert (first.is_extended_id, first.is_fd, first.is_error_frame, first.dlc) == (False, False, False, 8)


def test_a_copied_frame_is_the_same_frame() -> None:
    frame = CODEC.message("ENCODER").pack(1, 2)
    for twin in (copy.copy(frame), copy.deepcopy(frame)):
        assert isinstance(twin, Frame)
        assert twin.equals(frame)


def test_only_the_control_port_carries_control_and_nothing_else(ends: Ends) -> None:
    robot_end, far_end = ends
    with pytest.raises(ValueError, match=r"frame 0x1 refused, this port carries all but CONTROL"):
        robot_end.telemetry_port().send(encode_brake())
    control = robot_end.control_port()
    with pytest.raises(ValueError, match=r"frame 0x9 refused, this port carries only CONTROL"):
        control.send(CODEC.message("ENCODER").pack(0, 0))
    assert far_end.drain() == []
    control.send(encode_brake())
    assert [message.arbitration_id for message in far_end.drain()] == [0x01]


@pytest.mark.parametrize(
    "smuggled",
    [
        can.Message(arbitration_id=0x801, is_extended_id=False, data=encode_brake().data),
        can.Message(arbitration_id=0x4000_0001, is_extended_id=True, data=encode_brake().data),
        can.Message(arbitration_id=-0x7FF, is_extended_id=False, data=encode_brake().data),
    ],
)
def test_control_is_not_smuggled_out_by_a_wide_identifier(ends: Ends, smuggled: can.Message) -> None:
    robot_end, far_end = ends
    with pytest.raises(ValueError, match="does not fit its frame"):
        robot_end.telemetry_port().send(smuggled)
    assert far_end.drain() == []


def test_control_port_is_there_once(ends: Ends) -> None:
    robot_end, _ = ends
    robot_end.control_port()
    with pytest.raises(BusError, match="the CONTROL port is taken; one guard drives one robot"):
        robot_end.control_port()


def test_a_full_queue_is_told_to_the_sender_and_nothing_that_was_taken_is_lost(ends: Ends) -> None:
    robot_end, far_end = ends
    port = far_end.telemetry_port()
    frame = CODEC.message("ENCODER").pack(1, 1)
    for _ in range(4096):
        port.send(frame)
    with pytest.raises(BusError, match="sending failed"):
        port.send(frame)
    assert len(robot_end.drain()) == 4096
    port.send(frame)
    assert len(robot_end.drain()) == 1


def test_any_other_listener_of_python_can_hears_the_same_frames(ends: Ends) -> None:
    robot_end, far_end = ends
    channel = robot_end.name.partition(":")[2]
    with can.Bus(interface="virtual", channel=channel, rx_queue_size=3, ignore_config=True) as listener:
        send(far_end, cycle()[:3])
        heard = [listener.recv(0) for _ in range(3)]
        assert [message.data for message in heard if message] == [frame.data for frame in cycle()[:3]]
        assert all(message and message.timestamp > 0.0 and message.channel == channel for message in heard)

        listener.send(can.Message(arbitration_id=0x09, is_extended_id=False, data=b"12345678"))
        assert [bytes(message.data) for message in robot_end.drain()][3:] == [b"12345678"]

        send(far_end, cycle()[:3])
        with pytest.raises(BusError, match="a listener has too many frames waiting"):
            send(far_end, cycle()[:1])
    assert len(robot_end.drain()) == 4


def test_a_bus_that_was_shut_down_says_so_and_can_be_opened_anew() -> None:
    robot_end, far_end = bus_pair()
    port = robot_end.telemetry_port()
    robot_end.shutdown()
    robot_end.shutdown()
    with pytest.raises(BusError, match=f"bus {robot_end.name}: is shut down; open it again"):
        robot_end.drain()
    with pytest.raises(BusError, match="is shut down"):
        port.send(CODEC.message("ENCODER").pack(0, 0))
    robot_end.reopen()
    port.send(CODEC.message("ENCODER").pack(0, 0))
    assert len(far_end.drain()) == 1
    robot_end.shutdown()
    far_end.shutdown()


def test_a_bus_that_goes_away_is_told_in_one_line_until_it_is_reopened(ends: Ends) -> None:
    robot_end, far_end = ends
    pull_the_plug(robot_end)
    with pytest.raises(BusError, match=f"bus {robot_end.name}: receiving failed .*; check adapter, cable and power"):
        robot_end.drain()
    with pytest.raises(BusError, match=f"bus {robot_end.name}: sending failed"):
        send(robot_end, cycle())
    robot_end.reopen()
    send(far_end, cycle())
    assert len(robot_end.drain()) == len(cycle())


@pytest.mark.skipif(not Path("/sys/class/net/vcan0").exists(), reason="this kernel has no vcan0")
def test_socketcan_carries_frames_as_the_bus_in_this_process_does() -> None:
    robot_end, far_end = open_bus("vcan0"), open_bus("vcan0")
    send(far_end, cycle(counts=321))
    assert [bytes(message.data) for message in robot_end.drain()] == [frame.data for frame in cycle(counts=321)]
    assert robot_end.drain() == far_end.drain() == []
    robot_end.shutdown()
    far_end.shutdown()


@pytest.mark.parametrize(
    ("spec", "complaint"),
    [
        ("nocan7", r"bus 'nocan7': no such network interface; plug in the adapter, or set it up: ip link set nocan7"),
        ("", r"bus '': no such network interface.*ip link set can0 up"),
        ("lo", "bus 'lo': is a network interface, but not of CAN"),
        ("virtual:", r"bus 'virtual:': no such kind; give virtual:NAME or a SocketCAN interface such as can0"),
        ("serial:/dev/ttyS0", "no such kind"),
        ("can0\0", "no such network interface"),
    ],
)
def test_a_bus_that_cannot_be_opened_is_explained_in_one_line(spec: str, complaint: str) -> None:
    with pytest.raises(BusError, match=complaint) as caught:
        open_bus(spec)
    assert "\n" not in str(caught.value)
