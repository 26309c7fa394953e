"""Dead reckoning by the encoders."""

import math

import pytest

from hal.robot_settings import load_robot
from kurt2rt.recording.odometry import Odometry

GEOMETRY = load_robot().geometry


def ticks(way_m: float) -> int:
    return round(way_m / GEOMETRY.metres_per_tick)


def test_a_straight_way_leads_along_x() -> None:
    odometry = Odometry(GEOMETRY)
    for _ in range(100):
        odometry.drive(ticks(0.01), ticks(0.01))
    assert odometry.pose == pytest.approx((1.0, 0.0, 0.0), abs=1e-3)


def test_a_turn_on_the_spot_changes_the_heading_alone() -> None:
    odometry = Odometry(GEOMETRY)
    quarter_m = math.pi / 2 * GEOMETRY.effective_track_m / 2
    for _ in range(50):
        odometry.drive(-ticks(quarter_m / 50), ticks(quarter_m / 50))
    assert odometry.pose == pytest.approx((0.0, 0.0, math.pi / 2), abs=5e-3)


def test_a_whole_circle_ends_where_it_began() -> None:
    odometry = Odometry(GEOMETRY)
    radius_m, track_m = 0.5, GEOMETRY.effective_track_m
    for _ in range(1000):
        left_m = math.tau * (radius_m - track_m / 2) / 1000
        right_m = math.tau * (radius_m + track_m / 2) / 1000
        odometry.drive(ticks(left_m), ticks(right_m))
    assert odometry.pose == pytest.approx((0.0, 0.0, 0.0), abs=0.02)
