"""Rewards of environments: by the judge of the task, or by its teacher."""

import pytest

from behaviors.judges.judge import AppraisalFeatures
from kurt2rt.core.task_settings import load_task
from kurt2rt.gym.rewards import DecisionOutcome, JudgeReward, TeacherReward, build_reward
from tests.gym.helpers import environment, follow_teacher, press_on


class JudgeOfSpeed:
    """Judge that finds fast drives good."""

    def judge(self, features: AppraisalFeatures) -> int:
        return 1 if features.speed_m_s > 0.1 else -1


def features(speed_m_s: float) -> AppraisalFeatures:
    return AppraisalFeatures(0.2, 0.6, 0.6, 0.6, 0.6, 0.6, 0.0, 0.0, speed_m_s, 0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("action", "reward"), [("forward", 1), ("bear_left", 0), ("along_left_wall", 0), ("curve_left", -1), ("back", -1)]
)
def test_teacher_reward_compares_with_the_answer(action: str, reward: int) -> None:
    by_teacher = build_reward(load_task("circle"), None)
    assert isinstance(by_teacher, TeacherReward)
    assert by_teacher.reward(DecisionOutcome(action, "forward", None)) == reward


def test_judge_reward_is_the_judges() -> None:
    by_judge = JudgeReward(JudgeOfSpeed())
    assert [by_judge.reward(DecisionOutcome("back", "forward", features(speed))) for speed in (0.3, 0.0)] == [1, -1]
    assert by_judge.reward(DecisionOutcome("back", "forward", None)) == 0


@pytest.mark.parametrize(
    ("task", "kind", "expected"),
    [("fleeing", None, JudgeReward), ("fleeing", "teacher", TeacherReward), ("turn_left", None, TeacherReward)],
)
def test_reward_source_is_that_of_the_task(task: str, kind: str | None, expected: type) -> None:
    assert isinstance(build_reward(load_task(task), kind), expected)


def test_rewards_of_the_teachers_drive_beat_a_standing_robot() -> None:
    with environment() as env:
        taught = sum(step.reward for step in follow_teacher(env, 100, seed=1))
        env.reset(seed=1)
        assert taught > 50
        assert press_on(env, "stand", 20).reward == -1.0
