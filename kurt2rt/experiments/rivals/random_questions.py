"""Questions at random: a control that tells what it is worth that a robot asks where it knows least."""

import random
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from hal.robot_settings import RobotSettings
from kurt2rt.core.learner.learner import Label, LearnerFactory, Signal
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.learner_setting import learner_setting
from kurt2rt.experiments.rivals.jobs import RivalJob

EVERY_S = 20.0
"""Default of the mean time that it drives between two questions: 19 in 345 s, as the vote with R asked (4106-4125)."""


class RandomlyAskingTeam(LearnerTeam):
    """Learners that ask at moments of chance while a teacher is there, and wait for a lesson or for 8 s."""

    def __init__(
        self, name: str, make: LearnerFactory, task: TaskSettings, robot: RobotSettings, *, seed: int, every_s: float
    ) -> None:
        """Make learners without knowledge that drive for a mean time of `every_s`, in s, between two questions."""
        super().__init__(name, make, learner_setting(task, robot, seed=seed), task.behaviours)
        self._chance = random.Random(f"questions of {seed}")
        self._share = robot.cycle_s / every_s
        self._longest = round(8.0 / robot.cycle_s)
        self._left = 0
        """Ticks of the present question that are left."""

    def decide(self, behaviour: str, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        """Return the action for a situation (d,); None while it asks. To be called once in each tick.

        `taught`: whether a teacher is there who answers.
        """
        if taught and self._left == 0 and self._chance.random() < self._share:
            self._left = self._longest
        if taught and self._left:
            self._left -= 1
            return None
        return super().decide(behaviour, situation, taught=taught)

    def teach(self, lesson: Label | Signal) -> None:
        """Give a lesson to the learner of its behaviour, and end the question."""
        self._left = 0
        super().teach(lesson)


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomQuestionsJob(RivalJob):
    """Lesson of a robot that asks at random, over the CAN bus, which has ticks; and the exams of `RivalJob`."""

    gives_lesson: ClassVar[bool] = False

    def _team_of(self, make: LearnerFactory) -> LearnerTeam:
        every_s = EVERY_S if self.rival.gate is None else self.rival.gate
        return RandomlyAskingTeam(self.rival.name, make, self.task, self.robot, seed=self.seed, every_s=every_s)
