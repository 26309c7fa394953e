"""Dead reckoning by the encoders."""

import math

import pytest

from hal.kurt2_settings import load_kurt2
from hal.odometry import PlanePose, WheelOdometry

GEOMETRY = load_kurt2().geometry
TRACK_M = GEOMETRY.effective_track_m


def reckoned(left_m: float, right_m: float, steps: int) -> PlanePose:
    """Return the pose after `steps` cycles in which the sides drove these distances together."""
    odometry, pose = WheelOdometry(GEOMETRY), PlanePose()
    ticks = [round(side_m / steps / GEOMETRY.metres_per_tick) for side_m in (left_m, right_m)]
    for _ in range(steps):
        motion = odometry.motion(*ticks)
        pose = pose.moved(motion.forward_m, motion.turn_rad)
    return pose


def test_pose_both_sides_alike_leads_along_x() -> None:
    assert reckoned(1.0, 1.0, 100) == pytest.approx((1.0, 0.0, 0.0), abs=1e-3)


def test_pose_turn_on_the_spot_changes_heading_alone() -> None:
    quarter_m = math.pi / 2 * TRACK_M / 2
    assert reckoned(-quarter_m, quarter_m, 50) == pytest.approx((0.0, 0.0, math.pi / 2), abs=5e-3)


def test_motion_single_side_tells_distances_and_turn() -> None:
    motion = WheelOdometry(GEOMETRY).motion(0, 10)
    right_m = 10 * GEOMETRY.metres_per_tick
    assert motion == pytest.approx((0.0, right_m, right_m / 2, right_m / TRACK_M))
