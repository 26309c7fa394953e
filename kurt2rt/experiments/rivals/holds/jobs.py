"""Job of a rival that a teacher in charge teaches."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

from hal.simulation import Simulation
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.experiments.rivals.holds.lesson import teach_by_holds
from kurt2rt.experiments.rivals.jobs import RivalJob
from kurt2rt.experiments.rivals.learner_clock import LearnerClock
from kurt2rt.experiments.rivals.lesson import RivalLesson
from kurt2rt.runtime import Runtime


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldRivalJob(RivalJob):
    """Lesson by a teacher in charge, which the batch does not know, and the exams of `RivalJob`."""

    gives_lesson: ClassVar[bool] = False

    async def _teach_on_bus(
        self,
        simulation: Simulation,
        team: LearnerTeam | None,
        clock: LearnerClock,
        on_progress: Callable[[float], None],
    ) -> tuple[RivalLesson, Runtime]:
        return await teach_by_holds(
            simulation, self.robot, self.task, team, clock, self.after, seed=self.seed, on_progress=on_progress
        )
