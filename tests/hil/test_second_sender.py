"""Another node sends CONTROL: the robot stops in the same tick and says why."""

import pytest

from hal.bus import open_bus
from hal.control import encode_brake
from hal.guard_reason import GuardReason
from tests.hil.drive import Drive, cansend

pytestmark = pytest.mark.hil

FORWARD_30_CM_S = "001#0002001E001E0001"
STOP = "001#000001 03FF 0103FF".replace(" ", "")
STOPPED = ((0.0, 0.0), (GuardReason.FOREIGN_CONTROL,), True)


@pytest.mark.parametrize("frame", [FORWARD_30_CM_S, STOP, "001#"], ids=["drive", "stop", "empty"])
def test_foreign_control_stops_the_robot_in_the_same_tick(drive: Drive, frame: str) -> None:
    cansend(frame)
    assert drive.tick() == STOPPED
    assert drive.health.foreign_control == 1
    assert drive.health.trouble == drive.health.alarm != ""


def test_the_robot_obeys_a_stop_that_a_person_sends(drive: Drive) -> None:
    cansend(STOP)
    drive.until_it_stands()
    assert drive.grant == STOPPED


def test_the_other_may_be_in_the_same_program(drive: Drive, vcan0: str) -> None:
    other = open_bus(vcan0)
    other.control_port().send(encode_brake())
    assert drive.tick() == STOPPED
    other.shutdown()


def test_frames_with_other_identifiers_are_not_control(drive: Drive) -> None:
    cansend("00000001#0002001E001E0001")
    cansend("011#0002001E001E0001")
    drive.tick()
    assert (drive.health.foreign_control, drive.health.latched) == (0, None)
