"""Rays of the distance sensors, in the robot's frame."""

import math

import pytest

from hal.robot_settings import load_robot
from kurt2rt.runs.recording.foxglove_scene import SCAN_RAYS, SensorRays

INFRARED = load_robot().infrared
NOTHING = [INFRARED.floor_counts] * len(INFRARED.sensors)


def seen_by(name: str, distance_m: float) -> list[int]:
    """Return the counts of a robot that sees an obstacle with one sensor only."""
    counts = list(NOTHING)
    counts[INFRARED.names.index(name)] = round(INFRARED.counts_at(distance_m))
    return counts


def test_a_wall_ahead_stands_at_its_distance_from_the_centre() -> None:
    rays = SensorRays(INFRARED)
    counts = seen_by("s11", 0.3)
    scan = rays.scan_m(counts)
    assert scan[0] == pytest.approx(0.217 + 0.3, abs=0.005)
    assert sum(math.isfinite(each) for each in scan) == 1
    ray = rays.rays(counts)[INFRARED.names.index("s11")]
    assert (ray.from_x_m, ray.from_y_m, ray.to_y_m) == (0.217, 0.0, 0.0)
    assert ray.seen


def test_a_wall_to_the_left_is_a_quarter_turn_on() -> None:
    scan = SensorRays(INFRARED).scan_m(seen_by("s3", 0.2))
    (place,) = [number for number, each in enumerate(scan) if math.isfinite(each)]
    assert place == round(SCAN_RAYS * math.degrees(math.atan2(0.365, 0.047)) / 360)
    assert scan[place] == pytest.approx(math.hypot(0.047, 0.365), abs=0.005)
