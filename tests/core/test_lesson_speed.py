"""Lesson speed: the share of the speed, and the clock of the way."""

import pytest

from hal.robot import WheelSpeeds
from kurt2rt.core.lesson_speed import SLOWEST, LessonSpeed
from kurt2rt.core.task_settings import load_task


@pytest.mark.parametrize("share", [SLOWEST, 0.6, 0.99])
def test_slow_scales_both_wheels_and_counts_a_share_of_the_ticks(share: float) -> None:
    speed, counted = LessonSpeed(share), 0
    for _ in range(1000):
        assert speed.slow(WheelSpeeds(0.3, -0.1)) == WheelSpeeds(share * 0.3, share * -0.1)
        counted += speed.counts
    assert counted == pytest.approx(1000 * share, abs=1)


def test_end_counts_every_tick_again() -> None:
    speed = LessonSpeed(0.25)
    speed.slow(WheelSpeeds(0.3, 0.3))
    assert (speed.slows, speed.counts) == (True, False)
    speed.end()
    assert (speed.slows, speed.counts) == (False, True)


def test_slow_lesson_rescues_after_a_longer_time() -> None:
    task = load_task("wall_following", changes={"teaching.lesson_speed": "0.6"})
    assert task.teaching.slow_rescue_after_s == pytest.approx(task.teaching.rescue_after_s / 0.6)
    assert load_task("wall_following").teaching.slow_rescue_after_s == task.teaching.rescue_after_s
