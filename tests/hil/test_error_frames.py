"""Error frames of an adapter reach the robot through its receive filter."""

import can
import pytest

from hal.bus import open_bus
from hal.bus_state import ControllerState
from hal.guard_reason import GuardReason
from tests.hil.drive import Drive, cansend

pytestmark = pytest.mark.hil

# linux/can/error.h: CAN_ERR_FLAG with a class; of class 4 (controller) data[1] is the status, data[6..7] the counters.
IS_BUS_OFF = "20000040#0000000000000000"
IS_RESTARTED = "20000100#0000000000000000"
IS_PASSIVE = "20000004#0030000000008180"
IS_WARNING = "20000004#000C000000006061"
IS_ACTIVE = "20000004#0040000000000000"


def test_bus_off_stops_the_robot_in_the_same_tick(drive: Drive) -> None:
    cansend(IS_BUS_OFF)
    assert drive.tick() == ((0.0, 0.0), (GuardReason.BUS_OFF,), True)
    assert drive.health.controller is ControllerState.OFF
    assert drive.health.trouble == drive.health.controller_trouble != ""


def test_after_a_restart_the_trouble_is_over_and_the_stop_is_not(drive: Drive) -> None:
    cansend(IS_BUS_OFF)
    drive.tick()
    cansend(IS_RESTARTED)
    assert drive.ticks(50) == ((0.0, 0.0), (GuardReason.BUS_OFF,), True)
    assert drive.health.controller is ControllerState.ACTIVE
    drive.kurt2.release()
    drive.until_it_drives()
    assert drive.health.trouble == ""


@pytest.mark.parametrize(
    ("frame", "state", "counters"),
    [(IS_PASSIVE, ControllerState.PASSIVE, "129 errors sending and 128"), (IS_WARNING, ControllerState.WARNING, "96 ")],
)
def test_a_bus_that_grows_worse_is_told_and_driven_on(
    drive: Drive, frame: str, state: ControllerState, counters: str
) -> None:
    cansend(frame)
    drive.ticks(20)
    assert drive.health.controller is state
    assert f"{state}, {counters}" in drive.health.trouble
    drive.until_it_drives()
    cansend(IS_ACTIVE)
    drive.tick()
    assert (drive.health.controller, drive.health.trouble) == (ControllerState.ACTIVE, "")


def test_a_flood_of_error_frames_is_counted_and_stops_nothing(drive: Drive, vcan0: str) -> None:
    adapter = open_bus(vcan0)
    port = adapter.telemetry_port()
    not_acknowledged = can.Message(arbitration_id=0x20, is_extended_id=False, is_error_frame=True, dlc=8)
    before = drive.health.error_frames
    for _ in range(100):
        for _ in range(20):
            port.send(not_acknowledged)
        drive.tick()
    adapter.shutdown()
    drive.tick()
    assert drive.health.error_frames == before + 2000
    drive.until_it_drives()
