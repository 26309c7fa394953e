"""The bus in this process behaves as every bus does; one clear line says why there is none."""

import itertools
from collections.abc import Iterator

import can
import pytest

from hal.bus import BusError, open_bus
from hal.control import encode_brake
from hal.frame import Frame
from hal.in_process_bus import InProcessBus
from tests.hal.bus_conformance import Ends, ErrorFrameConformance, Join, joining
from tests.hal.helpers import CODEC, cycle, send

_numbers = itertools.count()


class TestInProcessBus(ErrorFrameConformance):
    @pytest.fixture
    def join(self) -> Iterator[Join]:
        name = f"virtual:conformance-{next(_numbers)}"
        with joining(lambda: open_bus(name)) as join:
            yield join


def test_a_reader_of_single_frames_gets_a_copy_with_a_time_stamp(ends: Ends) -> None:
    robot_end, far_end = ends
    reader = InProcessBus(robot_end.name.removeprefix("virtual:"))
    frame = cycle()[0]
    far_end.telemetry_port().send(frame)
    read = reader.recv(0)
    assert reader.recv(0) is None
    reader.shutdown()
    assert isinstance(read, Frame)
    assert read is not frame
    assert read.data is frame.data
    assert read.timestamp > 0.0 == frame.timestamp
    assert read.channel == reader.channel_id


def test_a_burst_is_as_so_many_single_frames(ends: Ends) -> None:
    robot_end, far_end = ends
    port, frame = far_end.telemetry_port(), CODEC.message("ENCODER").pack(1, 1)
    port.send_all(cycle())
    assert [message.data for message in robot_end.drain()] == [each.data for each in cycle()]
    for _ in range(4094):
        port.send(frame)
    with pytest.raises(BusError, match="sending failed"):
        port.send_all([frame] * 3)
    assert len(robot_end.drain()) == 4096
    with pytest.raises(ValueError, match="refused"):
        port.send_all([frame, encode_brake()])
    assert robot_end.drain() == []


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
        with pytest.raises(BusError, match="sending failed"):
            send(far_end, cycle()[:1])
    assert len(robot_end.drain()) == 4


def test_a_bus_whose_name_is_no_text_of_the_kernel_is_explained() -> None:
    with pytest.raises(BusError, match="no such network interface"):
        open_bus("can0\0")
