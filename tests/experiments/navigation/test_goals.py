"""Which goals were never demonstrated as a whole."""

import math
import random
from itertools import pairwise

import pytest

from behaviors.metrics.errands import ErrandsSettings
from behaviors.metrics.streets import Side
from behaviors.metrics.town import Street, Town
from kurt2rt.experiments.navigation.exam import choose_goals, demonstrated_m
from tests.behaviors.metrics.test_town import street, town

__all__ = ["town"]


def settings(**changes: float) -> ErrandsSettings:
    return ErrandsSettings.model_validate(
        {"kind": "errands", "names": 4, "goals": 5, "junctions_at_least": 3, "detour_at_most": 1.3, **changes}
    )


def walk(town: Town, *steps: str) -> list[Street]:
    led = [street(town, 1.3, 2.2, Side.EAST)]
    for behaviour in steps:
        led.append(town.on_from(led[-1])[behaviour])
    return led


def test_demonstrated_m_is_the_shortest_piece(town: Town) -> None:
    led = walk(town, *["turn_left"] * 4, "straight_on")
    first, second = led[0], led[1]
    assert demonstrated_m(led, first, second) == pytest.approx(1.8)
    assert demonstrated_m(led, second, first) == pytest.approx(3 * 1.8)
    last = led[-1]
    assert demonstrated_m(led, first, last) == pytest.approx(1.8)  # not all the way round the block
    assert demonstrated_m(led, last, first) == math.inf


def test_a_way_ends_where_the_robot_was_set_down(town: Town) -> None:
    led = walk(town, "straight_on", "turn_left")
    start, goal = led[0], led[2]
    assert demonstrated_m([led[0], led[1], None, led[1], led[2]], start, goal) == math.inf


def test_choose_goals_are_far_new_and_successive(town: Town) -> None:
    led = walk(town, "turn_left", "turn_right")
    named = {
        "near": street(town, 3.1, 2.2, Side.EAST),
        "far": street(town, 4.9, 5.8, Side.EAST),
        "south": street(town, 5.8, 1.3, Side.SOUTH),
    }
    start = led[0]
    goals = choose_goals(town, named, led, start, settings(), random.Random(1))
    assert len(goals) == 5
    assert goals[0].start == start
    assert all(before.street == after.start for before, after in pairwise(goals))
    assert all(len(goal.shortest) - 1 >= 3 and goal.demonstrated > 1.3 for goal in goals)
    assert "near" not in {goals[0].name}


def test_choose_goals_of_demonstrated_ways_is_empty(town: Town) -> None:
    steps = ["straight_on", "straight_on", "turn_left"]
    led = walk(town, *steps)
    start, goal = led[0], led[-1]
    assert choose_goals(town, {"there": goal}, led, start, settings(), random.Random(1)) == ()
    assert len(choose_goals(town, {"there": goal}, [start], start, settings(goals=1), random.Random(1))) == 1
