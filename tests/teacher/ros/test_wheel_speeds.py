"""Twists as speeds of both sides, and those that no robot follows."""

import math

import pytest

from hal.robot import WheelSpeeds
from kurt2rt.ros import messages as ros
from kurt2rt.teacher.ros.twist_drive import DriveLimits, TwistRefusedError, wheel_speeds

LIMITS = DriveLimits(track_m=0.5, max_m_s=0.9)


def of(*values: float) -> ros.Twist:
    return ros.Twist(ros.Vector3(*values[:3]), ros.Vector3(*values[3:]))


@pytest.mark.parametrize(
    ("twist", "speeds"),
    [
        (of(0.3, 0, 0, 0, 0, 0), WheelSpeeds(0.3, 0.3)),
        (of(-0.9, 0, 0, 0, 0, 0), WheelSpeeds(-0.9, -0.9)),
        (of(0.0, 0, 0, 0, 0, 2.0), WheelSpeeds(-0.5, 0.5)),
        (of(0.4, 0, 0, 0, 0, -2.0), WheelSpeeds(0.9, -0.1)),
        (of(0.0, 0, 0, 0, 0, -0.0), WheelSpeeds(0.0, 0.0)),
    ],
)
def test_twist_turns_left_by_a_quicker_right_side(twist: ros.Twist, speeds: WheelSpeeds) -> None:
    assert wheel_speeds(twist, LIMITS) == pytest.approx(speeds)


@pytest.mark.parametrize("at", [1, 2, 3, 4])
def test_twist_in_a_way_in_which_no_robot_moves_is_refused(at: int) -> None:
    values = [0.0] * 6
    values[at] = 0.1
    with pytest.raises(TwistRefusedError, match="only drives along x and turns about z"):
        wheel_speeds(of(*values), LIMITS)


@pytest.mark.parametrize("at", range(6))
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_twist_with_a_value_that_is_not_finite_is_refused(at: int, value: float) -> None:
    values = [0.0] * 6
    values[at] = value
    with pytest.raises(TwistRefusedError, match="not a finite number"):
        wheel_speeds(of(*values), LIMITS)


@pytest.mark.parametrize("twist", [of(0.91, 0, 0, 0, 0, 0), of(0.5, 0, 0, 0, 0, 1.61), of(-1e300, 0, 0, 0, 0, 1e300)])
def test_twist_too_fast_for_a_side_is_refused(twist: ros.Twist) -> None:
    with pytest.raises(TwistRefusedError, match=r"allowed is 0\.9; send less"):
        wheel_speeds(twist, LIMITS)
