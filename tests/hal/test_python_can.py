"""python-can's tools and `can.Bus` on a shared bus, by the plug-in."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

import can
import pytest

from hal.frame import Frame
from hal.python_can import INTERFACE
from hal.shared_bus import SharedBus


@pytest.fixture
def name() -> str:
    return f"plug-in-{os.getpid()}"


@pytest.fixture
def robot(name: str) -> Iterator[SharedBus]:
    """Yield the other end of the bus."""
    with SharedBus(name) as bus:
        yield bus


def test_logger_of_python_can_prints_frames_of_the_bus(name: str, robot: SharedBus) -> None:
    command = [sys.executable, "-m", "can.logger", "-i", INTERFACE, "-c", name]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as logger:
        assert logger.stdout is not None
        try:
            next(line for line in logger.stdout if line.startswith("Connected to Kurt2rtBus"))
            robot.send(Frame(0x04, b"\x01\x02"))
            line = next(line for line in logger.stdout if "ID:" in line)
        finally:
            logger.send_signal(signal.SIGINT)
    assert " 004 " in line
    assert "01 02" in line


def test_bus_stamps_frames_with_the_time_since_1970(name: str, robot: SharedBus) -> None:
    with can.Bus(interface=INTERFACE, channel=f"shared:{name}") as bus:
        robot.send(Frame(0x04, b"\x01"))
        frame = bus.recv(0)
    assert frame is not None
    assert frame.timestamp == pytest.approx(time.time(), abs=60.0)


def test_bus_filters_of_python_can_hold_without_waiting(name: str, robot: SharedBus) -> None:
    only: can.typechecking.CanFilters = [{"can_id": 0x05, "can_mask": 0x7FF, "extended": False}]
    with can.Bus(interface=INTERFACE, channel=name, can_filters=only, bitrate=1_000_000) as bus:
        for frame_id in (0x04, 0x05):
            robot.send(Frame(frame_id, b""))
        heard = [bus.recv(0), bus.recv(0.01)]
    assert [frame.arbitration_id for frame in heard if frame is not None] == [0x05]


def test_bus_sends_to_other_ends(name: str, robot: SharedBus) -> None:
    with can.Bus(interface=INTERFACE, channel=name) as bus:
        bus.send(can.Message(arbitration_id=0x10, data=b"\x07", is_extended_id=False))
        frame = robot.recv(0)
    assert frame is not None
    assert (frame.arbitration_id, bytes(frame.data)) == (0x10, b"\x07")


@pytest.mark.parametrize(
    "frame",
    [
        can.Message(arbitration_id=0x10, is_extended_id=False, is_fd=True, data=b"\x01"),
        can.Message(arbitration_id=0x10, is_extended_id=False, data=bytes(9)),
        can.Message(arbitration_id=0x800, is_extended_id=False),
        can.Message(arbitration_id=0x8000_0001),
        can.Message(arbitration_id=1 << 32),
        can.Message(arbitration_id=-1),
    ],
    ids=["FD", "long", "wide", "with flags", "over 32 bits", "negative"],
)
def test_frame_that_is_not_classic_can_is_a_can_error(name: str, robot: SharedBus, frame: can.Message) -> None:
    with (
        can.Bus(interface=INTERFACE, channel=name) as bus,
        pytest.raises(can.CanOperationError, match=f"^{INTERFACE} {name}: frame 0x"),
    ):
        bus.send(frame)
    assert robot.recv(0) is None


def test_open_bus_is_detected(name: str, robot: SharedBus) -> None:
    assert robot.channel == name
    found = can.detect_available_configs(INTERFACE)
    assert [each["channel"] for each in found].count(name) == 1
    assert {each["interface"] for each in found} == {INTERFACE}


def test_bus_without_a_channel_is_refused_with_their_names(name: str) -> None:
    with SharedBus(name), pytest.raises(can.CanInitializationError, match=rf"there are: .*\b{re.escape(name)}\b"):
        can.Bus(interface=INTERFACE)


@pytest.mark.parametrize(
    ("channel", "options", "fault"),
    [
        ("no/name", {}, "letters, digits"),
        ("desk", {"fd": True}, "CAN FD and receive_own_messages"),
        ("desk", {"receive_own_messages": True}, "CAN FD and receive_own_messages"),
    ],
)
def test_bus_that_cannot_be_is_refused(channel: str, options: dict[str, Any], fault: str) -> None:
    with pytest.raises(can.CanInitializationError, match=fault):
        can.Bus(interface=INTERFACE, channel=channel, **options)
