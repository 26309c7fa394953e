"""Listings of the troubles of a robot on its bus, and of the errors of a bus that cannot be opened."""

from collections.abc import Callable, Iterator

import pytest

from hal.bus import BusError, open_bus
from hal.bus_state import BusState
from hal.frame import Frame
from hal.guard_reason import GuardReason
from tests.hal.desk_bus import Ride
from tests.hal.helpers import TICK_S, cycle, error_frame, ticks


def troubles() -> Iterator[tuple[str, str]]:
    """Yield the trouble of a robot that drives at 0.3 m/s until it is stopped for a reason, and of a warned adapter."""
    causes: dict[GuardReason, Callable[[Ride], None]] = {
        GuardReason.BUS_BLOCKED: _carry_nothing,
        GuardReason.BUS_OFF: lambda ride: ride.desk.arrive(error_frame(0x040)),
        GuardReason.FOREIGN_CONTROL: lambda ride: ride.desk.arrive(Frame(0x01, bytes(8))),
        GuardReason.FOREIGN_TELEMETRY: _send_too_often,
        GuardReason.WHEELS_DISOBEY: lambda ride: _repeat(ride, cycle(200, ticks(0.3), 0)),
        GuardReason.INFRARED_FROZEN: lambda ride: _repeat(ride, cycle(200, ticks(0.3), ticks(0.3))),
    }
    for reason, cause in causes.items():
        ride = Ride()
        ride.drive_for(1.0)
        cause(ride)
        if ride.kurt2.health.latched is None:
            ride.decide()
        assert ride.kurt2.health.latched is reason
        yield reason, ride.kurt2.health.trouble
        ride.close()
    state = BusState("can0")
    state.note(error_frame(0x004, status=0x04, sending=1, receiving=96))
    yield "adapter warned", state.trouble
    for classes in (0x020, 0x020, 0x020, 0x088, 0x008):
        state.note(error_frame(classes))
    state.note(error_frame(0x204, status=0x20, sending=128, receiving=7))
    yield "adapter passive", state.trouble


def opening() -> Iterator[tuple[str, str]]:
    """Yield the error of each name of a bus that cannot be opened."""
    for name in ("nocan7", "", "lo", "virtual:", "serial:x", "shared:", "shared:a/b"):
        with pytest.raises(BusError) as caught:
            open_bus(name)
        yield repr(name), str(caught.value)


def _carry_nothing(ride: Ride) -> None:
    ride.desk.carries = False
    ride.drive_for(3 * TICK_S)


def _send_too_often(ride: Ride) -> None:
    """Let another node send the bumpers' frames, too."""
    ride.desk.arrive(*100 * [cycle()[-1]])
    ride.drive_for(25 * TICK_S)


def _repeat(ride: Ride, frames: list[Frame]) -> None:
    """Let the controller send these frames in each cycle, until the robot is stopped."""
    while ride.kurt2.health.latched is None:
        ride.desk.arrive(*frames)
        ride.sleep(TICK_S)
        ride.decide()
