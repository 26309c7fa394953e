"""Motion of the simulated robot: modes, limits, slip, collisions."""

import pytest

from hal.control import Control, Mode, RawControl, RawSide, SpeedControl
from simbridge.contracts.simulation import Pose
from tests.simbridge.rig import ROBOT, Rig, board, facing_wall, room

RAW_DRIVE = RawControl(RawSide(650), RawSide(650))


@pytest.mark.parametrize(
    ("control", "speed_m_s"),
    [
        (SpeedControl(Mode.SPEED_CM, 30, 30), 0.30),
        (SpeedControl(Mode.SPEED_CM, -30, -30), -0.30),
        (SpeedControl(Mode.SPEED, 40, 40), 0.4 * 0.69),
        (RAW_DRIVE, 0.27),
        (RawControl(RawSide(650, backward=True), RawSide(650, backward=True)), -0.27),
        (RawControl(RawSide(350), RawSide(350)), 0.0),  # the dead band
    ],
)
def test_each_mode_drives_at_its_set_point(control: Control, speed_m_s: float, rig: Rig) -> None:
    rig.run(2.0, control)
    assert rig.speed_m_s == pytest.approx(speed_m_s, abs=0.002)
    before = rig.robot.pose
    rig.run(2.0, control)
    assert rig.robot.pose.x_m - before.x_m == pytest.approx(2.0 * speed_m_s, rel=0.05, abs=1e-6)


def test_wall_ahead_blocks_the_body_and_is_one_collision(rig: Rig) -> None:
    rig.robot.place(facing_wall(0.3))
    rig.drive(30, 30, 3.0)
    blocked = rig.robot.pose
    rig.drive(30, 30, 2.0)
    assert rig.robot.pose.x_m == pytest.approx(blocked.x_m, abs=0.005)
    assert rig.robot.pose.x_m + ROBOT.geometry.outline_length_m / 2 == pytest.approx(4.0, abs=0.005)
    assert rig.speed_m_s == pytest.approx(0.30, abs=0.01)  # the wheels slip on
    assert rig.heard["BUMPERC"] == (0b000111, 0)
    assert (rig.robot.touching, rig.robot.bumped, rig.robot.collisions) == (True, True, 1)


def test_second_contact_is_a_second_collision(rig: Rig) -> None:
    rig.robot.place(facing_wall(0.1))
    rig.drive(20, 20, 2.0)
    rig.drive(-20, -20, 1.5)
    assert (rig.robot.touching, rig.robot.bumped, rig.robot.collisions) == (False, False, 1)
    assert rig.heard["BUMPERC"] == (0, 0)
    rig.drive(20, 20, 3.0)
    assert rig.robot.collisions == 2


@pytest.mark.parametrize("speed_cm_s", [90])
def test_thin_wall_stops_the_robot_at_any_speed(speed_cm_s: int) -> None:
    for heading_rad in (0.0, 0.8):
        with Rig(room(walls=[board((3.0, 0.0), (3.0, 4.0))])) as rig:
            rig.robot.place(Pose(2.3, 1.5, heading_rad))
            rig.drive(speed_cm_s, speed_cm_s, 3.0)
            assert rig.robot.pose.x_m < 2.99 - ROBOT.geometry.outline_width_m / 2 + 0.01
            assert 0.0 < rig.robot.pose.y_m < 4.0
