"""Settings of one episode: world, seed, start and endings."""

import random
from dataclasses import dataclass

from hal.robot_settings import RobotSettings
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.exam import ExamSetup
from kurt2rt.gym.endings import Ending
from simbridge.contracts.simulation import Pose

PURPOSE = "exam"
"""Purpose of the simulations, so that seeds make the starts and the noise of exams."""


@dataclass(frozen=True, slots=True)
class EpisodeSetup:
    """Robot, task, world, seed and start of one episode of an environment."""

    settings: RobotSettings
    task: TaskSettings
    """Task with one behaviour and without a mid level."""
    world: str
    seed: int
    start: Pose | None
    """None: where the exam of this seed begins."""
    ends_at: frozenset[Ending]
    ticks: int
    """Length of the episode."""
    averages: bool = True
    """True if the averages of the situation are observed."""
    judged: bool = True
    """True if the critic's features are needed."""

    def chance(self) -> random.Random:
        """Return the random choices of the course and of the start, those of the exam with this seed."""
        return random.Random(ExamSetup(self.world, self.seed).chance_seed)
