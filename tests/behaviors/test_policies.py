"""The other reference policies, as their tasks set them."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from behaviors.policies.finding import policy_settings
from behaviors.policies.policy import PolicySettings
from behaviors.policies.wall_following import WallFollowingSettings
from behaviors.repertoire import load_repertoire
from kurt2rt.tasks.settings import load_task
from tests.behaviors.helpers import ROBOT, counts

TASKS = {name: load_task(name) for name in ("fleeing", "circle", "eight", "streets")}
POLICIES = {name: task.policy.build(ROBOT.infrared) for name, task in TASKS.items()}
ACTIONS = set(load_repertoire("basic", ROBOT))
LEFT, RIGHT = ("s1", "s3", "s4", "s2"), ("s5", "s7", "s8", "s6")
VIEWS = st.tuples(*[st.one_of(st.integers(0, 1023), st.sampled_from((0, 70, 71, 549, 550, 551, 1023)))] * 18)


def said(task: str, distances_m: dict[str, float], behaviour: str = "") -> str:
    return POLICIES[task].choose(counts(**distances_m), behaviour)


def beside(left_m: float = 0.6, right_m: float = 0.6) -> dict[str, float]:
    """Walls along both sides."""
    return dict.fromkeys(LEFT, left_m) | dict.fromkeys(RIGHT, right_m)


@given(view=VIEWS, before=VIEWS)
@settings(max_examples=80)
def test_each_names_an_action_of_the_repertoire_whatever_is_seen_and_was_seen(
    view: tuple[int, ...], before: tuple[int, ...]
) -> None:
    for name, policy in POLICIES.items():
        for behaviour in TASKS[name].behaviours:
            action = policy.choose(view, behaviour)
            assert action in ACTIONS
            policy.choose(before, behaviour)
            assert policy.choose(view, behaviour) == action


@pytest.mark.parametrize(
    ("distances_m", "action"),
    [
        ({}, "forward"),
        ({"s11": 0.28}, "spin_left"),
        ({"s15": 0.2}, "spin_left"),
        ({"s16": 0.2}, "spin_left"),  # the same way from either side
        (beside(left_m=0.11), "bear_right"),
        (beside(right_m=0.11), "bear_left"),
        ({"s14": 0.1}, "forward"),  # behind: flee
    ],
)
def test_fleeing(distances_m: dict[str, float], action: str) -> None:
    assert said("fleeing", distances_m) == action


@pytest.mark.parametrize(
    ("distances_m", "action"),
    [
        ({"s3": 0.3}, "curve_left"),  # abeam
        ({"s4": 0.3}, "curve_left"),
        ({"s1": 0.3}, "forward"),  # ahead of abeam
        ({"s2": 0.2}, "curve_left"),  # behind, but too near
        ({"s1": 0.15}, "bear_right"),  # ahead, and too near
        ({"s2": 0.45}, "spin_left"),  # behind, and far off
        ({"s11": 0.25}, "spin_right"),  # until it is on the left
        ({"s5": 0.3}, "spin_right"),
        ({"s14": 0.3}, "spin_left"),
        ({"s15": 0.4}, "forward"),
        ({}, "curve_left"),
    ],
)
def test_the_circle(distances_m: dict[str, float], action: str) -> None:
    assert said("circle", distances_m) == action


@pytest.mark.parametrize(
    ("distances_m", "action"),
    [
        (beside(left_m=0.2) | {"s1": 0.26, "s2": 0.26}, "bear_left"),
        (beside(left_m=0.3), "curve_left"),
        (beside(right_m=0.3), "curve_right"),
        (beside(left_m=0.25) | {"s16": 0.4}, "forward"),  # the other column comes into view
        ({"s2": 0.3, "s16": 0.4}, "forward"),  # its back to the one, towards the other
        ({"s2": 0.3, "s5": 0.3, "s7": 0.25}, "bear_right"),
        ({}, "curve_left"),
        ({"s10": 0.15}, "spin_right"),
    ],
)
def test_the_eight(distances_m: dict[str, float], action: str) -> None:
    assert said("eight", distances_m) == action


MIDDLE = beside(0.235, 0.235)
AT_A_CROSSING = MIDDLE | dict.fromkeys(("s1", "s3", "s5", "s7"), 0.6)


@pytest.mark.parametrize(
    ("behaviour", "distances_m", "action"),
    [
        ("straight_on", MIDDLE, "forward"),
        ("turn_left", MIDDLE, "forward"),
        ("straight_on", beside(0.20, 0.27), "bear_right"),
        ("straight_on", beside(0.27, 0.20), "bear_left"),
        ("straight_on", beside(0.35, 0.12), "curve_left"),
        ("straight_on", beside(left_m=0.21), "bear_right"),  # one wall is enough
        ("straight_on", AT_A_CROSSING, "forward"),
        ("turn_left", AT_A_CROSSING, "curve_left"),
        ("turn_right", AT_A_CROSSING, "curve_right"),
        ("straight_on", AT_A_CROSSING | {"s15": 0.1}, "curve_right"),
        ("turn_left", {"s11": 0.2}, "spin_left"),
        ("turn_right", {"s11": 0.2}, "spin_right"),
    ],
)
def test_the_streets(behaviour: str, distances_m: dict[str, float], action: str) -> None:
    assert said("streets", distances_m, behaviour) == action


def test_a_policy_is_found_by_its_name() -> None:
    assert policy_settings("wall_following") is WallFollowingSettings
    assert issubclass(policy_settings("streets"), PolicySettings)
    with pytest.raises(
        ValueError, match="there is no kind 'flying'; give one of: circle, eight, fleeing, streets, wall"
    ):
        policy_settings("flying")
