"""Rewards of -1, 0 or +1 for one decision of an agent."""

from collections.abc import Mapping
from enum import StrEnum
from typing import NamedTuple, Protocol

from behaviors.action_groups import action_groups
from behaviors.judges.judge import AppraisalFeatures, Judge
from config.settings import SettingsError
from kurt2rt.core.task_settings import TaskSettings


class RewardKind(StrEnum):
    """Source of an environment's rewards, by its option `reward`."""

    JUDGE = "judge"
    """The task's judge, which sees how the robot drives."""
    TEACHER = "teacher"
    """The task's reference policy, compared with the agent's action."""


class DecisionOutcome(NamedTuple):
    """Decision of an agent and what came of it, from which a `Reward` computes the reward."""

    action: str
    teachers_answer: str
    """Action of the reference policy for the observation that the agent decided on."""
    features: AppraisalFeatures | None
    """Critic's features after the decision; None while the robot is blind."""


class Reward(Protocol):
    """Reward function of an environment, called once for each decision of the agent."""

    def reward(self, outcome: DecisionOutcome) -> int:
        """Return the reward of a decision: -1, 0 or +1."""
        ...


class JudgeReward:
    """Reward of the task's judge for the way the robot drives at the end of the decision."""

    def __init__(self, judge: Judge) -> None:
        self._judge = judge

    def reward(self, outcome: DecisionOutcome) -> int:
        """Return the judge's reward, -1, 0 or +1; 0 while the robot is blind."""
        return 0 if outcome.features is None else self._judge.judge(outcome.features)


class TeacherReward:
    """Reward +1 for the teacher's action, 0 for one that looks like it, -1 for another one."""

    def __init__(self, groups: Mapping[str, str]) -> None:
        """Set the group of each action by its name; a person who watches cannot tell two of a group apart."""
        self._groups = groups

    def reward(self, outcome: DecisionOutcome) -> int:
        """Return +1, 0 or -1 for the agent's action, as compared with the teacher's."""
        if outcome.action == outcome.teachers_answer:
            return 1
        return 0 if self._groups[outcome.action] == self._groups[outcome.teachers_answer] else -1


def build_reward(task: TaskSettings, kind: str | None) -> Reward:
    """Return the rewards of a task: by the judge if it has one, else by the teacher, unless `kind` names the source.

    Raises config.settings.SettingsError for an unknown source, or for a judge that the task lacks.
    """
    if kind is not None and kind not in set(RewardKind):
        raise SettingsError(f"reward: unknown source (got {kind}, allowed {', '.join(RewardKind)})")
    if kind == RewardKind.TEACHER or (kind is None and task.judge is None):
        return TeacherReward(action_groups(task.repertoire))
    if task.judge is None:
        raise SettingsError(f"reward: the task {task.name} has no judge", do=f"give reward={RewardKind.TEACHER.value}")
    return JudgeReward(task.judge.build())
