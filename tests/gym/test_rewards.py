"""Rewards of environments: by the judge of the task, or by its teacher."""

import pytest

from kurt2rt.core.task_settings import load_task
from kurt2rt.gym.rewards import DecisionOutcome, JudgeReward, TeacherReward, build_reward


@pytest.mark.parametrize(
    ("action", "reward"), [("forward", 1), ("bear_left", 0), ("along_left_wall", 0), ("curve_left", -1), ("back", -1)]
)
def test_teacher_reward_compares_with_the_answer(action: str, reward: int) -> None:
    by_teacher = build_reward(load_task("circle"), None)
    assert isinstance(by_teacher, TeacherReward)
    assert by_teacher.reward(DecisionOutcome(action, "forward", None)) == reward


@pytest.mark.parametrize(
    ("task", "kind", "expected"),
    [("fleeing", None, JudgeReward), ("fleeing", "teacher", TeacherReward), ("turn_left", None, TeacherReward)],
)
def test_reward_source_is_that_of_the_task(task: str, kind: str | None, expected: type) -> None:
    assert isinstance(build_reward(load_task(task), kind), expected)
