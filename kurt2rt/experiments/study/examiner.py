"""Examiner of a taught robot in one world."""

from collections.abc import Sequence
from dataclasses import dataclass

from hal.robot_settings import RobotSettings
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report, run_drives
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.experiments.lockstep.exam import ExamSetup
from simbridge.contracts.simulation import SimulationFactory


@dataclass(frozen=True, slots=True)
class Examiner:
    """Examiner of one robot in one world, by the policy's own drive from the same start."""

    factory: SimulationFactory
    robot: RobotSettings
    task: TaskSettings
    world: str
    seed: int
    report: Report
    engine: Engine = Engine.CAN

    async def drive_policy(self) -> DriveRow:
        """Return the policy's own drive; it passes if it has no collision, alarm or standstill.

        Raises SettingsError if task and world do not fit.
        """
        policy = await self._drive(ExamSetup(self.world, self.seed, teacher_policy=True))
        return policy.judged_by(policy.progress, self.task.exam.success)

    async def examine(
        self, policy: DriveRow, events: Sequence[TeachingEvent], learners: LearnerTeam | None = None
    ) -> DriveRow:
        """Return the drive of a taught robot, judged by the policy's drive.

        A world in which the policy itself does not pass is no measure, and the drive is not judged.

        Args:
            policy: own drive of the policy.
            events: lessons of the RLAs.
            learners: decide in place of the RLAs; None: RLAs decide.

        Raises:
            SettingsError: task and world do not fit.
            LessonLostError: the robot refused a command.
        """
        exam = await self._drive(ExamSetup(self.world, self.seed, events=events, learners=learners))
        return exam.judged_by(policy.progress, self.task.exam.success) if policy.passed else exam

    async def _drive(self, setup: ExamSetup) -> DriveRow:
        (result,) = await run_drives(self.factory, self.robot, self.task, [setup], self.report, self.engine)
        return result.stored()
