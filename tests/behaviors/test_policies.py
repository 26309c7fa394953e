"""Reference policies with the settings of the shipped tasks."""

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from behaviors.repertoire import load_repertoire
from config import CONFIG_DIR
from kurt2rt.core.task_settings import load_task
from tests.behaviors.helpers import ROBOT, SENSORS, counts
from tests.examples import examples

TASKS = {path.stem: load_task(path.stem) for path in sorted((CONFIG_DIR / "tasks").glob("*.yaml"))}
POLICIES = {name: task.policy.build(ROBOT.infrared) for name, task in TASKS.items()}
ACTIONS = {name: set(load_repertoire(task.repertoire, ROBOT)) for name, task in TASKS.items()}
LEFT, RIGHT = ("s1", "s3", "s4", "s2"), ("s5", "s7", "s8", "s6")
VIEWS = st.tuples(*[st.one_of(st.integers(0, 1023), st.sampled_from((0, 70, 71, 549, 550, 551, 1023)))] * 18)

_PAIRS = (*zip(LEFT, RIGHT, strict=True), ("s9", "s10"), ("s12", "s13"), ("s15", "s16"), ("s17", "s18"))
_ACROSS = dict(_PAIRS) | {right: left for left, right in _PAIRS}


def said(task: str, distances_m: dict[str, float], behaviour: str = "") -> str:
    return POLICIES[task].choose(counts(**distances_m), behaviour)


def walls_at(left_m: float = 0.6, right_m: float = 0.6) -> dict[str, float]:
    """Return the distances of walls along both sides."""
    return dict.fromkeys(LEFT, left_m) | dict.fromkeys(RIGHT, right_m)


def mirrored_view(view: tuple[int, ...]) -> tuple[int, ...]:
    """Return the view in the world's mirror image."""
    return tuple(view[SENSORS.index(_ACROSS.get(name, name))] for name in SENSORS)


def mirrored(name: str) -> str:
    """Return the mirror image of an action or a taught behaviour."""
    swapped = {"left": "right", "right": "left"}
    return "_".join(swapped.get(word, word) for word in name.split("_"))


# Of all


@pytest.mark.parametrize("name", TASKS)
@given(view=VIEWS, before=VIEWS)
@examples(20)
def test_policies_name_actions_and_have_no_memory(name: str, view: tuple[int, ...], before: tuple[int, ...]) -> None:
    task, policy = TASKS[name], POLICIES[name]
    for behaviour in task.behaviours:
        action = task.policy.build(ROBOT.infrared).choose(view, behaviour)
        assert action in ACTIONS[name]
        for earlier in task.behaviours:
            policy.choose(before, earlier)
            assert policy.choose(view, behaviour) == action


# Fleeing


@pytest.mark.parametrize(
    ("distances_m", "action"),
    [
        ({}, "flee"),
        ({"s11": 0.45}, "whirl_left"),
        ({"s9": 0.45}, "whirl_left"),
        ({"s15": 0.25}, "whirl_left"),
        ({"s16": 0.25}, "whirl_left"),  # the same way from either side
        ({"s15": 0.4}, "curve_right"),
        ({"s16": 0.4}, "curve_left"),
        (walls_at(0.11, 0.11), "flee"),  # along the walls
        (dict.fromkeys(("s12", "s13", "s14"), 0.1), "flee"),  # what is behind
    ],
)
def test_fleeing_policy(distances_m: dict[str, float], action: str) -> None:
    assert said("fleeing", distances_m) == action


# Circle


@pytest.mark.parametrize(
    ("distances_m", "action"),
    [
        ({"s4": 0.25}, "curve_left"),  # abeam
        ({"s2": 0.25}, "curve_left"),
        ({"s3": 0.25}, "bear_left"),  # ahead of abeam
        ({"s1": 0.25}, "bear_left"),
        ({"s3": 0.4}, "curve_left"),  # far off it curves in sooner
        ({"s1": 0.4}, "bear_left"),
        ({"s1": 0.15}, "forward"),  # too near
        ({"s3": 0.15}, "forward"),
        ({"s2": 0.15}, "forward"),
        ({"s2": 0.5}, "curve_left"),
        ({"s4": 0.25, "s11": 0.12}, "curve_left"),  # it never looks ahead
    ],
)
def test_circle_policy(distances_m: dict[str, float], action: str) -> None:
    assert said("circle", distances_m) == action


@given(view=VIEWS)
def test_circle_policy_without_an_object_spins_left(view: tuple[int, ...]) -> None:
    unseen = tuple(70 if name in LEFT else seen for name, seen in zip(SENSORS, view, strict=True))
    assert POLICIES["circle"].choose(unseen, "") == "spin_left"


# Eight


@pytest.mark.parametrize(
    ("distances_m", "action"),
    [
        ({"s3": 0.18}, "curve_left"),  # round the column on the left
        ({"s4": 0.18}, "curve_left"),
        ({"s7": 0.18}, "curve_right"),  # round the one on the right
        ({"s3": 0.10}, "bear_left"),  # too near
        ({"s3": 0.30}, "sharp_left"),  # too far
        ({"s1": 0.18}, "bear_left"),  # the nose turns to it
        ({"s2": 0.18}, "sharp_left"),  # the nose turns away
        ({"s1": 0.30, "s3": 0.32}, "curve_left"),  # too far, but it turns to it
        ({"s2": 0.20, "s16": 0.30}, "forward"),  # the other column comes into view: across to it
        ({"s17": 0.30, "s16": 0.30}, "forward"),
        ({"s2": 0.20, "s16": 0.15}, "curve_left"),  # not into it
        ({"s1": 0.18, "s6": 0.30}, "forward"),  # still on the way across
        ({"s2": 0.20, "s7": 0.18}, "curve_right"),  # across: its back to the one, round the other
        ({"s17": 0.40}, "sharp_left"),  # lost behind
        ({"s18": 0.40}, "sharp_right"),
        ({}, "curve_left"),
        ({"s10": 0.15, "s15": 0.30}, "spin_right"),  # away from the nearer column
        ({"s10": 0.15, "s16": 0.30}, "spin_left"),
    ],
)
def test_eight_policy(distances_m: dict[str, float], action: str) -> None:
    assert said("eight", distances_m) == action


@st.composite
def columns(draw: st.DrawFn) -> dict[str, float]:
    """Draw one column per side, or one on one side alone; one of both lies farther ahead."""
    from_the_front = (("s15", "s16"), *zip(LEFT, RIGHT, strict=True), ("s17", "s18"), ())
    left, right = draw(st.permutations(from_the_front))[:2]
    distance_m = st.floats(0.11, 0.30)
    return {sensor: draw(distance_m) for sensor in (*left[:1], *right[1:])}


@given(seen=columns(), in_front=st.one_of(st.none(), st.tuples(*[st.floats(0.1, 0.6)] * 3)))
@examples(200)
def test_eight_policy_is_symmetric(seen: dict[str, float], in_front: tuple[float, float, float] | None) -> None:
    """One side is preferred only for two columns equally far ahead or equally near."""
    view = counts(**seen, **(dict(zip(("s9", "s11", "s10"), in_front, strict=True)) if in_front else {}))
    to_left, to_right = (
        max(view[SENSORS.index(name)] for name in names) for names in (("s15", *LEFT), ("s16", *RIGHT))
    )
    assume(to_left != to_right or in_front is None)
    assert POLICIES["eight"].choose(mirrored_view(view), "") == mirrored(POLICIES["eight"].choose(view, ""))


# Streets

MIDDLE = walls_at(0.235, 0.235)
AT_A_CROSSING = MIDDLE | dict.fromkeys(("s1", "s3", "s5", "s7"), 0.6)
ASKEW = {"s1": 0.19, "s3": 0.22, "s4": 0.25, "s2": 0.28}


@pytest.mark.parametrize(
    ("behaviour", "distances_m", "action"),
    [
        ("straight_on", MIDDLE, "forward"),
        ("turn_left", MIDDLE, "forward"),
        ("straight_on", walls_at(0.20, 0.27), "bear_right"),
        ("straight_on", walls_at(0.27, 0.20), "bear_left"),
        ("turn_right", walls_at(0.20, 0.27), "bear_right"),
        ("straight_on", walls_at(0.35, 0.12), "sharp_left"),
        ("straight_on", walls_at(left_m=0.21), "forward"),
        ("straight_on", walls_at(left_m=0.19), "bear_right"),  # one wall is enough
        ("straight_on", ASKEW, "sharp_right"),  # the nose turns to it
        ("straight_on", AT_A_CROSSING, "forward"),
        ("turn_left", AT_A_CROSSING, "sharp_left"),
        ("turn_right", AT_A_CROSSING, "sharp_right"),
        ("turn_right", MIDDLE | {"s1": 0.6}, "forward"),  # the other side opens
        # In a street 1.1 m wide, 9 cm off the middle: the far wall is no open side.
        ("turn_right", walls_at(0.295, 0.475), "sharp_right"),
        ("turn_left", walls_at(0.295, 0.475), "sharp_right"),
        ("straight_on", {"s15": 0.2, "s16": 0.4}, "bear_right"),  # in it only the corners are seen
        ("straight_on", {"s15": 0.3, "s16": 0.3}, "forward"),
        ("straight_on", {}, "forward"),
        ("turn_left", {"s11": 0.15}, "spin_left"),
        ("turn_right", {"s11": 0.15}, "spin_right"),
        ("straight_on", {"s9": 0.15}, "spin_right"),  # away from it
        ("straight_on", {"s10": 0.15}, "spin_left"),
    ],
)
def test_streets_policy(behaviour: str, distances_m: dict[str, float], action: str) -> None:
    assert said("streets", distances_m, behaviour) == action


@pytest.mark.parametrize("behaviour", TASKS["streets"].behaviours)
@given(view=st.one_of(VIEWS, st.tuples(*[st.integers(70, 550)] * 18)))
@examples(200)
def test_streets_policy_is_symmetric(behaviour: str, view: tuple[int, ...]) -> None:
    """One side is preferred only for a wall dead ahead on the way straight on."""
    ahead = [ROBOT.infrared.distance_m(view[SENSORS.index(name)]) for name in ("s9", "s10")]
    assume(behaviour != "straight_on" or ahead[0] != ahead[1])
    policy = POLICIES["streets"]
    assert policy.choose(mirrored_view(view), mirrored(behaviour)) == mirrored(policy.choose(view, behaviour))


# Wall following


def wall_on_the_left(front_m: float, back_m: float | None = None) -> dict[str, float]:
    """Return the distances of the four left sensors along a straight wall."""
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
        (wall_on_the_left(0.20) | {"s1": 0.6}, "forward"),  # the wall ends at the nose: not yet
        (wall_on_the_left(0.20) | {"s1": 0.6, "s3": 0.6}, "curve_left"),
        (wall_on_the_left(0.20) | {"s1": 0.6, "s3": 0.6, "s15": 0.27}, "forward"),  # its corner is still near ahead
        (wall_on_the_left(0.20) | {"s1": 0.6, "s3": 0.6, "s16": 0.12}, "spin_left"),  # no room for a curve
        (wall_on_the_left(0.20) | {"s16": 0.12}, "forward"),
        (wall_on_the_left(0.20) | dict.fromkeys(("s5", "s6", "s7", "s8", "s12"), 0.2), "forward"),
    ],
)
def test_wall_following_policy(distances_m: dict[str, float], action: str) -> None:
    assert said("wall_following", distances_m) == action
