"""Judges with the settings of the shipped tasks."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviors.judges.judge import AppraisalFeatures, Judge, mirrored
from kurt2rt.core.task_settings import load_task
from tests.examples import examples

TASKS = ("wall_following", "fleeing", "eight")
OPEN = AppraisalFeatures(*[0.6] * 6, *[0.0] * 7)._replace(speed_m_s=0.3)

distances_m = st.floats(0.1, 0.6)
flags = st.sampled_from((0.0, 0.0, 0.0, 1.0))
anywhere = st.builds(
    AppraisalFeatures,
    *[distances_m] * 6,
    *[st.floats(-1.1, 1.1)] * 2,
    st.floats(-0.3, 0.5),
    st.floats(-1.5, 1.5),
    *[flags] * 3,
    circling=flags,
    grazing=flags,
    spun=flags,
)


def judge_of(task: str) -> Judge:
    settings = load_task(task).judge
    assert settings is not None
    return settings.build()


JUDGES = {task: judge_of(task) for task in TASKS}


def thinks(task: str, **circumstances: float) -> int:
    """Return the reward for features that differ by these from a straight course in the open."""
    return JUDGES[task].judge(OPEN._replace(**circumstances))


# Of all


def test_mirrored_features_are_the_same_twice_mirrored() -> None:
    one_sided = OPEN._replace(left_m=0.1, ahead_right_m=0.2, right_angle_rad=0.3, turn_rad_s=0.4)
    assert mirrored(one_sided) == OPEN._replace(right_m=0.1, ahead_left_m=0.2, left_angle_rad=0.3, turn_rad_s=-0.4)
    assert mirrored(mirrored(one_sided)) == one_sided


@given(circumstances=anywhere)
@examples(100)
def test_wall_on_the_right_is_judged_as_in_a_mirror(circumstances: AppraisalFeatures) -> None:
    settings = load_task("wall_following", changes={"judge.side": "right"}).judge
    assert settings is not None
    assert settings.build().judge(mirrored(circumstances)) == JUDGES["wall_following"].judge(circumstances)


@pytest.mark.parametrize("task", TASKS)
@given(circumstances=anywhere)
@examples(100)
def test_judges_always_punish_common_faults(task: str, circumstances: AppraisalFeatures) -> None:
    assert JUDGES[task].judge(circumstances) in {-1, 0, 1}
    for trouble in (
        {"bumped": 1.0},
        {"speed_m_s": -0.1},
        {"speed_m_s": 0.0, "turn_rad_s": 0.0},
        {"no_progress": 1.0, "speed_m_s": 0.05, "circling": 1.0},
    ):
        assert JUDGES[task].judge(circumstances._replace(**trouble)) == -1


# Wall following

ALONG = {"left_m": 0.2, "ahead_left_m": 0.3}


@pytest.mark.parametrize(
    ("circumstances", "thought"),
    [
        (ALONG, 1),
        (ALONG | {"left_m": 0.25}, 1),
        (ALONG | {"left_m": 0.28}, 0),  # too far off, and straight on
        (ALONG | {"left_m": 0.28, "turn_rad_s": 0.5, "speed_m_s": 0.22}, 1),  # it mends that
        (ALONG | {"left_m": 0.32, "turn_rad_s": -0.5, "speed_m_s": 0.22}, -1),  # it makes it worse
        (ALONG | {"left_m": 0.11}, 0),  # too close
        (ALONG | {"left_m": 0.11, "turn_rad_s": -0.5, "speed_m_s": 0.22}, 1),
        (ALONG | {"left_m": 0.11, "turn_rad_s": 0.5, "speed_m_s": 0.22}, -1),
        (ALONG | {"left_m": 0.16, "left_angle_rad": 0.5}, 1),  # close, but on its way off
        (ALONG | {"speed_m_s": 0.15}, 0),  # slow
        (ALONG | {"turn_rad_s": 1.0, "speed_m_s": 0.0}, -1),  # spins to the wall
        (ALONG | {"turn_rad_s": 1.0, "speed_m_s": 0.0, "ahead_right_m": 0.15}, 0),  # but in a narrow place
        (ALONG | {"turn_rad_s": -1.0, "speed_m_s": 0.0}, 0),
        (
            ALONG | {"turn_rad_s": -1.0, "speed_m_s": 0.0, "left_angle_rad": 0.5, "ahead_left_m": 0.5},
            -1,
        ),  # away from it for nothing
        (ALONG | {"front_m": 0.2, "turn_rad_s": -1.0, "speed_m_s": 0.0}, 1),  # it turns where it must
        (ALONG | {"front_m": 0.2, "turn_rad_s": 0.5, "speed_m_s": 0.2}, -1),
        (ALONG | {"front_m": 0.2}, 0),  # not yet too late
        (ALONG | {"ahead_left_m": 0.2, "turn_rad_s": -1.0, "speed_m_s": 0.0}, 1),
        ({"turn_rad_s": 0.5, "speed_m_s": 0.22}, 1),  # round the end of the wall
        ({}, 0),
        ({"turn_rad_s": -0.5, "speed_m_s": 0.22}, -1),
        ({"no_wall": 1.0}, -1),
        ({"no_wall": 1.0, "turn_rad_s": 0.5, "speed_m_s": 0.22}, 0),  # it looks for one
    ],
)
def test_wall_following_judge(circumstances: dict[str, float], thought: int) -> None:
    assert thinks("wall_following", **circumstances) == thought


# Fleeing


@pytest.mark.parametrize(
    ("circumstances", "thought"),
    [
        ({"speed_m_s": 0.4}, 1),
        ({"speed_m_s": 0.4, "left_m": 0.11, "right_m": 0.11, "rear_m": 0.1, "no_wall": 1.0}, 1),  # along the walls
        ({"speed_m_s": 0.2}, -1),  # creeps where it is free
        ({"speed_m_s": 0.2, "spun": 1.0}, 0),  # speeds up after a spin
        ({"front_m": 0.4, "speed_m_s": 0.0, "turn_rad_s": 1.4, "no_progress": 1.0}, 1),  # out of a corner
        ({"front_m": 0.4, "speed_m_s": 0.0, "turn_rad_s": 1.4, "no_progress": 1.0, "circling": 1.0}, -1),  # for ever
        ({"speed_m_s": 0.3}, 0),
        ({"speed_m_s": 0.0, "turn_rad_s": 1.4}, 0),
        ({"speed_m_s": 0.0, "turn_rad_s": -1.4}, -1),
        ({"front_m": 0.4, "speed_m_s": 0.0, "turn_rad_s": 1.4}, 1),  # the same way whatever is near
        ({"ahead_left_m": 0.25, "speed_m_s": 0.0, "turn_rad_s": 1.4}, 1),
        ({"front_m": 0.4, "speed_m_s": 0.0, "turn_rad_s": -1.4}, -1),
        ({"front_m": 0.4, "speed_m_s": 0.4}, 0),  # not yet too late
        ({"front_m": 0.25, "speed_m_s": 0.4}, -1),
        ({"ahead_right_m": 0.4, "speed_m_s": 0.22, "turn_rad_s": 0.5}, 0),
        ({"ahead_right_m": 0.4, "speed_m_s": 0.22, "turn_rad_s": -0.5}, -1),
        ({"ahead_left_m": 0.4, "speed_m_s": 0.22, "turn_rad_s": 0.5}, -1),
        ({"ahead_left_m": 0.4, "speed_m_s": 0.4}, 1),
    ],
)
def test_fleeing_judge(circumstances: dict[str, float], thought: int) -> None:
    assert thinks("fleeing", **circumstances) == thought


# Eight

ROUND = {"left_m": 0.18, "turn_rad_s": 0.5, "speed_m_s": 0.22}


@pytest.mark.parametrize(
    ("circumstances", "thought"),
    [
        (ROUND, 1),
        (ROUND | {"left_m": 0.1}, 0),  # as near as it can tell
        (ROUND | {"left_m": 0.35}, 0),
        (ROUND | {"turn_rad_s": 0.0}, 0),
        (ROUND | {"turn_rad_s": -0.5}, -1),  # away from it
        (ROUND | {"turn_rad_s": -0.5, "ahead_left_m": 0.2}, 0),  # not into it
        ({"left_m": 0.3, "right_m": 0.3}, 1),  # between the two
        ({"left_m": 0.3, "right_m": 0.3, "turn_rad_s": 0.5}, 0),
        (ROUND | {"left_m": 0.11, "grazing": 1.0}, -1),  # it closes in on the column
        (ROUND | {"left_m": 0.11, "turn_rad_s": 0.3, "grazing": 1.0}, 1),  # wide enough
        (ROUND | {"circling": 1.0}, 0),  # round the same column again
        (ROUND | {"circling": 1.0, "right_m": 0.45}, -1),  # past the other one
        ({"left_m": 0.3, "right_m": 0.3, "circling": 1.0}, 1),  # and now it leaves
        ({}, -1),  # it has just lost both
        ({"no_wall": 1.0}, 0),  # it searches
        ({"turn_rad_s": -0.5, "speed_m_s": 0.22, "no_wall": 1.0}, -1),  # with neither in view: left, by agreement
        ({"turn_rad_s": -0.5, "speed_m_s": 0.22, "ahead_right_m": 0.4}, 0),
        ({"turn_rad_s": 1.0, "speed_m_s": 0.0}, -1),
        ({"turn_rad_s": 1.0, "speed_m_s": 0.0, "front_m": 0.15}, 1),
        ({"front_m": 0.18}, 0),
    ],
)
def test_eight_judge(circumstances: dict[str, float], thought: int) -> None:
    assert thinks("eight", **circumstances) == thought


@given(circumstances=anywhere)
@examples(200)
def test_eight_judge_is_symmetric(circumstances: AppraisalFeatures) -> None:
    """One side is preferred only without a column at the sides."""
    now = circumstances._replace(left_m=min(circumstances.left_m, 0.3))
    mirrored = now._replace(
        left_m=now.right_m,
        right_m=now.left_m,
        ahead_left_m=now.ahead_right_m,
        ahead_right_m=now.ahead_left_m,
        left_angle_rad=now.right_angle_rad,
        right_angle_rad=now.left_angle_rad,
        turn_rad_s=-now.turn_rad_s,
    )
    assert JUDGES["eight"].judge(mirrored) == JUDGES["eight"].judge(now)
