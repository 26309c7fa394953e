"""Lesson speed: the share of the speed, and the clock of the way."""

import pytest

from kurt2rt.core.task_settings import load_task


def test_slow_lesson_rescues_after_a_longer_time() -> None:
    task = load_task("wall_following", changes={"teaching.lesson_speed": "0.6"})
    assert task.teaching.slow_rescue_after_s == pytest.approx(task.teaching.rescue_after_s / 0.6)
    assert load_task("wall_following").teaching.slow_rescue_after_s == task.teaching.rescue_after_s
