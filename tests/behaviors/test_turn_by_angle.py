"""Turn on the spot by an angle, with wheels that follow their set points at once."""

import math

import pytest

from behaviors.turn_by_angle import TurnByAngle
from hal.robot import STANDSTILL, WheelSpeeds
from tests.behaviors.helpers import ROBOT, sensed

TRACK_M, METRES_PER_TICK = ROBOT.geometry.effective_track_m, ROBOT.geometry.metres_per_tick
PERIOD_S = 0.01


def turn(angle_deg: float) -> TurnByAngle:
    behaviour = TurnByAngle(ROBOT.geometry, angle_deg=angle_deg, speed_m_s=0.20)
    behaviour.start()
    return behaviour


def drive(behaviour: TurnByAngle, ticks: int, first: WheelSpeeds = STANDSTILL) -> tuple[float, WheelSpeeds]:
    """Return the angle turned to the left in deg and the last set points; `first`: initial wheel speeds."""
    moving, turned_m = first, 0.0
    for _ in range(ticks):
        left_ticks, right_ticks = (round(speed * PERIOD_S / METRES_PER_TICK) for speed in moving)
        turned_m += (right_ticks - left_ticks) * METRES_PER_TICK
        moving = behaviour.step(sensed(left_ticks=left_ticks, right_ticks=right_ticks))
    return math.degrees(turned_m / TRACK_M), moving


@pytest.mark.parametrize("angle_deg", [90.0, -360.0, 5.0])
def test_turn_reaches_the_angle_and_stands(angle_deg: float) -> None:
    degrees_per_tick = math.degrees(2 * 0.20 * PERIOD_S / TRACK_M)
    turned_deg, last = drive(turn(angle_deg), 2000)
    assert turned_deg == pytest.approx(angle_deg, abs=degrees_per_tick)
    assert last == STANDSTILL


def test_turn_ignores_straight_motion() -> None:
    behaviour = turn(90.0)
    for _ in range(1000):
        assert behaviour.step(sensed(left_ticks=300, right_ticks=300)) == WheelSpeeds(-0.20, 0.20)
