"""The reference policy of wall following, with the wall on the left."""

import pytest

from kurt2rt.tasks.settings import load_task
from tests.behaviors.helpers import ROBOT, counts

TASK = load_task("wall_following")
POLICY = TASK.policy.build(ROBOT.infrared)


def wall_on_the_left(front_m: float, back_m: float | None = None) -> dict[str, float]:
    """Distances of the four left sensors along a straight wall."""
    back_m = front_m if back_m is None else back_m
    return {
        name: front_m + (back_m - front_m) * share
        for name, share in (("s1", 0), ("s3", 1 / 3), ("s4", 2 / 3), ("s2", 1))
    }


@pytest.mark.parametrize(
    ("distances_m", "action"),
    [
        (wall_on_the_left(0.20), "forward"),
        (wall_on_the_left(0.23), "bear_left"),
        (wall_on_the_left(0.30), "curve_left"),
        (wall_on_the_left(0.17), "bear_right"),
        (wall_on_the_left(0.12), "curve_right"),
        (wall_on_the_left(0.25, 0.20), "bear_left"),  # turned away from it
        (wall_on_the_left(0.20, 0.26), "bear_right"),  # turned to it
        (wall_on_the_left(0.20) | {"s11": 0.24}, "spin_right"),
        (wall_on_the_left(0.20) | {"s9": 0.24}, "spin_right"),
        (wall_on_the_left(0.20) | {"s10": 0.24}, "spin_right"),
        (wall_on_the_left(0.20) | {"s11": 0.27}, "forward"),
        (wall_on_the_left(0.20) | {"s15": 0.20}, "spin_right"),
        (wall_on_the_left(0.20) | {"s15": 0.24}, "forward"),
        (wall_on_the_left(0.20) | {"s4": 0.08}, "spin_right"),  # nearer than the sensors can tell
        ({}, "curve_left"),  # nothing anywhere
        (wall_on_the_left(0.20) | {"s1": 0.6}, "forward"),  # the wall ends beside the nose: not yet
        (wall_on_the_left(0.20) | {"s1": 0.6, "s3": 0.6}, "curve_left"),
        (wall_on_the_left(0.20) | {"s1": 0.6, "s3": 0.6, "s15": 0.27}, "forward"),  # its corner is still near ahead
        (wall_on_the_left(0.20) | {"s1": 0.6, "s3": 0.6, "s16": 0.12}, "spin_left"),  # no room for a curve
        (wall_on_the_left(0.20) | {"s16": 0.12}, "forward"),
        (wall_on_the_left(0.20) | dict.fromkeys(("s5", "s6", "s7", "s8", "s12"), 0.2), "forward"),
    ],
)
def test_what_a_consistent_person_would_say(distances_m: dict[str, float], action: str) -> None:
    assert POLICY.choose(counts(**distances_m), "") == action
