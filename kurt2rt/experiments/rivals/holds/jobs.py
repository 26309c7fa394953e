"""Job of a rival that a teacher in charge teaches."""

from dataclasses import dataclass
from typing import ClassVar

from hal.simulation import Simulation
from kurt2rt.experiments.rivals.holds.lesson import teach_by_holds
from kurt2rt.experiments.rivals.jobs import RivalJob
from kurt2rt.experiments.rivals.learner_clock import LearnerClock
from kurt2rt.experiments.rivals.lesson import OnProgress, RivalLesson, RivalSetup


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldRivalJob(RivalJob):
    """Lesson by a teacher in charge, which the batch does not know, and the exams of `RivalJob`."""

    gives_lesson: ClassVar[bool] = False

    async def _teach_on_bus(
        self, simulation: Simulation, setup: RivalSetup, clock: LearnerClock, on_progress: OnProgress
    ) -> RivalLesson:
        return await teach_by_holds(simulation, setup, clock, on_progress)
