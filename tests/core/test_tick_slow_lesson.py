"""Slow lessons in the tick: the guard is asked for a share of the decided speeds, only while a teacher teaches."""

import pytest

from hal.robot import STANDSTILL, WheelSpeeds
from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.teaching.commands import Appraise, Reward, SetLessonSpeed
from tests.core.test_tick import FORWARD, Corridor
from tests.teacher.helpers import resume, stop, teach

SHARE = 0.6
SLOW_FORWARD = WheelSpeeds(SHARE * FORWARD.left_m_s, SHARE * FORWARD.right_m_s)


def slow(share: float = SHARE, teacher: str = "Ann") -> SetLessonSpeed:
    return SetLessonSpeed(f"slow-{share}-{teacher}", teacher, round(100 * share))


@pytest.fixture
def driving() -> Corridor:
    """Return a robot that drives forward in a slow lesson."""
    corridor = Corridor()
    corridor.run(100, slow(), teach("forward", "first"))
    return corridor


def test_exam_drives_at_full_speed() -> None:
    corridor = Corridor(asked=False)
    corridor.run(100, slow(), teach("forward", "first"))
    assert corridor.run().decision.wheel_speeds == corridor.robot.driven[-1] == FORWARD


def test_stopped_robot_stands_in_a_slow_lesson(driving: Corridor) -> None:
    record = driving.run(100, stop())
    assert (driving.robot.driven[-1], record.lesson_speed) == (STANDSTILL, 1.0)
    driving.run(100, resume())
    assert driving.robot.driven[-1] == SLOW_FORWARD


@pytest.mark.parametrize("share", [0.0, 0.19, 1.01, -1.0])
def test_lesson_speed_out_of_range_is_refused(driving: Corridor, share: float) -> None:
    (result,) = driving.run(100, slow(share)).results
    assert result.outcome == Outcome.of(RefusalCode.NO_LESSON_SPEED, percent=round(100 * share), least=20)
    assert driving.run().lesson_speed == SHARE


@pytest.mark.parametrize(
    "signal", [Reward("signal", "Ann", -1), Reward("signal", "Ann", 1, 2)], ids=["present tick", "earlier tick"]
)
def test_reward_of_a_slow_tick_is_refused(driving: Corridor, signal: Reward) -> None:
    driving.run()
    (result,) = driving.run(100, signal).results
    assert result.code is RefusalCode.DROVE_SLOWLY


def test_appraisal_without_a_critic_is_refused_for_that(driving: Corridor) -> None:
    (result,) = driving.run(100, Appraise("signal", "Ann", "bad")).results
    assert result.code is RefusalCode.NO_CRITIC
