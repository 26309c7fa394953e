"""Counts of a robot in a batch, and the rule of being stuck, which equals that of the exam."""

import math
import random

import pytest

from kurt2rt.experiments.lockstep.episode import StuckDetector, build_stuck_rule
from simbridge.batch.laws import StuckLaw
from simbridge.batch.record import Sizes, count_tick, empty_robots
from simbridge.contracts.simulation import Pose

PERIOD_S = 0.01
RULE = build_stuck_rule(3.0, PERIOD_S, least_m=0.5)
SIZES = Sizes(1, 1, 1)
"""One size for all tests: each one is compiled by itself."""


@pytest.mark.parametrize("seed", range(3))
def test_batch_robot_is_stuck_in_the_tick_of_the_detector(seed: int) -> None:
    chance = random.Random(seed)
    detector = StuckDetector(3.0, PERIOD_S, least_m=0.5)
    robot = empty_robots(1, SIZES)[0]
    robot.kept_since = 1
    x_m = y_m = heading_rad = 0.0
    found: list[int] = []
    for tick in range(1, 3000):
        # It slows down, so each seed is stuck in another tick.
        step_m = 0.004 * math.exp(-tick / 500)
        heading_rad += chance.gauss(0.0, 0.03)
        x_m, y_m = x_m + step_m * math.cos(heading_rad), y_m + step_m * math.sin(heading_rad)
        robot.tick, robot.x_m, robot.y_m = tick, x_m, y_m
        count_tick(robot, StuckLaw(*RULE))
        stuck = detector.none_since_window(Pose(x_m, y_m, heading_rad))
        assert stuck == bool(robot.stuck)
        if stuck:
            found.append(tick)
            break
    assert found
    assert found[0] > 301
