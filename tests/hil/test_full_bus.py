"""A bus that is full, slow or blocked, and what others send on it."""

from collections.abc import Iterator
from contextlib import contextmanager

import can
import pytest

from hal.bus import BusError, CanBus, open_bus
from hal.control import RawControl, SpeedControl, decode_control, encode_brake
from hal.guard_reason import GuardReason
from tests.hal.helpers import CODEC
from tests.hil.drive import Drive
from tests.hil.link import Link

pytestmark = pytest.mark.hil


@contextmanager
def listener(vcan0: str) -> Iterator[CanBus]:
    """Return a third interface that receives CONTROL alone."""
    bus = open_bus(vcan0)
    bus.set_id_filter({0x01})
    yield bus
    bus.shutdown()


def test_blocked_bus_gets_two_set_points_then_brakes(drive: Drive, link: Link, vcan0: str) -> None:
    with listener(vcan0) as bus:
        link.hold_frames_for(1000)
        grants = [drive.tick() for _ in range(5)]
        assert [grant.latched for grant in grants] == [False, False, True, True, True]
        assert grants[2:] == [((0.0, 0.0), (GuardReason.BUS_BLOCKED,), True)] * 3
        assert drive.health.latched is GuardReason.BUS_BLOCKED
        # All of them come at last: what stood in the queue was two set points, and then brakes.
        carried = [decode_control(frame.data) for frame in frames_of(bus, 5)]
        assert [type(control) for control in carried] == [
            SpeedControl,
            SpeedControl,
            RawControl,
            RawControl,
            RawControl,
        ]
        assert carried[2:] == [decode_control(encode_brake().data)] * 3


def test_freed_bus_robot_waits_for_resume(drive: Drive, link: Link) -> None:
    link.hold_frames_for(1000)
    drive.ticks(5)
    link.carry_at_once()
    drive.until_fresh()
    assert drive.ticks(20) == ((0.0, 0.0), (GuardReason.BUS_BLOCKED,), True)
    drive.kurt2.release()
    drive.until_it_drives()


def test_silently_lost_frames_do_not_prevent_a_resume(drive: Drive, link: Link) -> None:
    link.hold_frames_for(60_000)
    drive.ticks(5)
    link.lose_what_waits()
    drive.until_fresh()
    drive.kurt2.release()
    drive.until_it_drives()


def test_a_queue_that_others_have_filled_stops_the_robot(drive: Drive, link: Link, vcan0: str) -> None:
    link.carry_at_most(1000, queue_bytes=3200)
    other = open_bus(vcan0)
    with pytest.raises(BusError, match="queue"):
        fill(other)
    assert drive.tick() == ((0.0, 0.0), (GuardReason.BUS_LOST,), True)
    assert "queue" in drive.health.trouble
    drive.ticks(20)
    assert drive.health.send_failures > 1  # it goes on braking
    other.shutdown()
    link.carry_at_once()
    drive.until_fresh()
    drive.kurt2.release()
    drive.until_it_drives()


@pytest.mark.parametrize("extended", [False, True], ids=["junk", "extended"])
def test_flood_of_junk_on_a_used_identifier_is_a_second_sender(drive: Drive, vcan0: str, extended: bool) -> None:
    """65535 counts, which no converter has, are counted as junk; no controller sends so often.

    An extended identifier is another message, which the filter keeps away.
    """
    other = open_bus(vcan0)
    junk = can.Message(arbitration_id=CODEC.message("BDC00_03").frame_id, is_extended_id=extended, data=b"\xff" * 8)
    for _ in range(100):
        for _ in range(20):
            other.telemetry_port().send(junk)
        drive.tick()
    other.shutdown()
    drive.tick()
    assert drive.health.junk == (0 if extended else 2000)
    assert drive.health.latched == (None if extended else GuardReason.FOREIGN_TELEMETRY)
    assert max(drive.readings.infrared_counts) < 600
    drive.ticks(150)  # an identifier has one sender again after a second
    drive.kurt2.release()
    drive.until_it_drives()


def fill(bus: CanBus) -> None:
    """Send until that fails."""
    port, frame = bus.telemetry_port(), can.Message(arbitration_id=0x7FF, is_extended_id=False, data=bytes(8))
    while True:
        port.send(frame)


def frames_of(bus: CanBus, count: int) -> list[can.Message]:
    """So many frames, as they come."""
    frames: list[can.Message] = []
    while len(frames) < count:
        frames += bus.drain()
    return frames
