"""Motion of an obstacle in a sensor's beam, against the geometry of the robot's pose."""

import math

import pytest

from hal.kurt2_settings import load_kurt2
from hal.odometry import PlanePose
from hal.sensor_signs import beam_of, obstacle_motion_m, sensor_limits

ROBOT = load_kurt2()
INFRARED = ROBOT.infrared


@pytest.mark.parametrize("place", range(len(INFRARED.sensors)), ids=INFRARED.names)
@pytest.mark.parametrize(("forward_m", "turn_rad"), [(1e-5, 0.0), (0.0, 1e-5), (2e-5, -3e-5)])
def test_beam_motion_is_that_of_a_standing_obstacle(place: int, forward_m: float, turn_rad: float) -> None:
    sensor, counts = INFRARED.sensors[place], 250.0
    heading_rad = math.radians(sensor.heading_deg)
    distance_m = INFRARED.distance_m(counts)
    x_m = sensor.x_m + distance_m * math.cos(heading_rad)
    y_m = sensor.y_m + distance_m * math.sin(heading_rad)
    pose = PlanePose().moved(forward_m, turn_rad)
    ahead_m, left_m = x_m - pose.x_m, y_m - pose.y_m
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    dx_m, dy_m = ahead_m * cos + left_m * sin - x_m, left_m * cos - ahead_m * sin - y_m
    across_m = dy_m * math.cos(heading_rad) - dx_m * math.sin(heading_rad)
    along_m = dx_m * math.cos(heading_rad) + dy_m * math.sin(heading_rad)
    found = obstacle_motion_m(counts, (forward_m, turn_rad), beam_of(INFRARED, place), sensor_limits(ROBOT))
    assert found == pytest.approx((across_m, along_m), abs=1e-9)


def test_beam_dark_counts_are_below_those_of_a_pressed_sensor() -> None:
    dark = sensor_limits(ROBOT).dark_counts
    pressed = [INFRARED.counts_at(distance_m / 1000) for distance_m in range(101)]
    assert INFRARED.floor_counts * 1.2 < dark < min(pressed)


def test_a_sensor_whose_floor_is_0_is_never_stuck() -> None:
    blind = ROBOT.model_copy(update={"infrared": INFRARED.model_copy(update={"floor_counts": 0})})
    assert sensor_limits(ROBOT).stuck_ticks * ROBOT.cycle_s == pytest.approx(4.0)
    assert sensor_limits(blind).stuck_ticks * ROBOT.cycle_s > 1e9
