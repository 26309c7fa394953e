"""A frame is as old as the kernel's stamp says, however late the program looks."""

import time

import pytest

from hal.guard_reason import GuardReason
from tests.hil.drive import FORWARD, Drive

pytestmark = pytest.mark.hil


def test_frames_queued_while_the_program_hung_are_old(drive: Drive) -> None:
    drive.simulated.step()
    time.sleep(0.06)  # the program hangs, and the robot with it: nothing newer comes
    now_s = drive.now_s
    readings = drive.kurt2.sense(now_s)
    assert min(readings.infrared_age_s, readings.encoder_age_s, readings.bumper_age_s) >= 0.06
    assert drive.kurt2.drive(FORWARD, now_s, now_s).reasons == (GuardReason.INFRARED_STALE,)
    drive.until_it_drives()


def test_a_frame_that_comes_at_once_is_young(drive: Drive) -> None:
    ages_s = []
    for _ in range(100):
        drive.tick()
        ages_s.append(drive.readings.infrared_age_s)
    assert min(ages_s) < 0.01
    assert min(ages_s) > 0.0
