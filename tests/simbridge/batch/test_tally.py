"""Counts of a robot in a batch, and the rule of being stuck, which equals that of the exam."""

import math
import random

import pytest

from hal.simulation import Pose
from kurt2rt.experiments.lockstep.episode import StuckDetector, build_stuck_rule
from simbridge.batch.laws import StuckLaw
from simbridge.batch.record import Sizes, empty_robots
from simbridge.batch.tally import count_tick

PERIOD_S = 0.01
NO_RULE = StuckLaw(1, 0, 0.0)
RULE = build_stuck_rule(3.0, PERIOD_S, least_m=0.5)
SIZES = Sizes(1, 1, 1)
"""One size for all tests: each one is compiled by itself."""


def test_questions_and_unknown_ticks_are_counted() -> None:
    robot = empty_robots(1, SIZES)[0]
    asked = False
    for tick, action in enumerate([2, -1, -1, 3, -1], start=1):
        robot.tick, robot.action = tick, action
        count_tick(robot, asked, NO_RULE)
        asked = action < 0
    assert (robot.unknown_ticks, robot.questions, robot.first_question) == (3, 2, 2)


def test_first_collision_keeps_its_tick() -> None:
    robot = empty_robots(1, SIZES)[0]
    for tick, collisions in enumerate([0, 1, 1, 2], start=1):
        robot.tick, robot.collisions = tick, collisions
        count_tick(robot, False, NO_RULE)
    assert robot.first_collision == 2


def test_distance_is_measured_from_the_tenth_tick_on() -> None:
    robot = empty_robots(1, SIZES)[0]
    for tick in range(1, 36):
        robot.tick, robot.x_m = tick, 0.003 * tick
        count_tick(robot, False, NO_RULE)
    assert robot.travelled_m == pytest.approx(0.06)


@pytest.mark.parametrize("seed", range(8))
def test_batch_robot_is_stuck_in_the_tick_of_the_detector(seed: int) -> None:
    chance = random.Random(seed)
    detector = StuckDetector(3.0, PERIOD_S, least_m=0.5)
    robot = empty_robots(1, SIZES)[0]
    x_m = y_m = heading_rad = 0.0
    found: list[int] = []
    for tick in range(1, 3000):
        # It slows down, so each seed is stuck in another tick.
        step_m = 0.004 * math.exp(-tick / 500)
        heading_rad += chance.gauss(0.0, 0.03)
        x_m, y_m = x_m + step_m * math.cos(heading_rad), y_m + step_m * math.sin(heading_rad)
        robot.tick, robot.x_m, robot.y_m = tick, x_m, y_m
        count_tick(robot, False, StuckLaw(*RULE))
        stuck = detector.none_since_window(Pose(x_m, y_m, heading_rad))
        assert stuck == bool(robot.stuck)
        if stuck:
            found.append(tick)
            break
    assert found
    assert found[0] > 301
