"""Job of a rival that is taught by rewards."""

from dataclasses import dataclass, replace
from typing import ClassVar

from hal.simulation import Simulation
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan
from kurt2rt.experiments.phases.steps import reward_plan
from kurt2rt.experiments.rivals.jobs import RivalJob
from kurt2rt.experiments.rivals.learner_clock import LearnerClock
from kurt2rt.experiments.rivals.lesson import OnProgress, RivalLesson, RivalSetup, teach_rival


@dataclass(frozen=True, slots=True, kw_only=True)
class RewardedRivalJob(RivalJob):
    """Lesson by the rewards of phase 3, which the batch does not know, and the exams of `RivalJob`."""

    gives_lesson: ClassVar[bool] = False

    @property
    def plan(self) -> LessonPlan:
        """Plan of phase 3, whose teacher answers questions, too; of these rivals only RLAs ask.

        The limit on rewards of -1 is for RLAs that know most already. Learners of rewards have nothing else.
        """
        plan = reward_plan(self.task, self.task.teaching.duration_s, "lesson")
        return replace(plan, times=replace(plan.times, most_blame=0)) if self.rival.is_learner else plan

    async def _teach_on_bus(
        self,
        simulation: Simulation,
        setup: RivalSetup,
        clock: LearnerClock,  # noqa: ARG002 - learners of rewards are fitted at once
        on_progress: OnProgress,
    ) -> RivalLesson:
        return await teach_rival(simulation, setup, on_progress, self.plan)
