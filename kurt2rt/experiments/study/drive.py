"""Stored drives without a teacher, each judged by the drive of the teacher's policy from the same start."""

from collections.abc import Sequence
from dataclasses import dataclass

from hal.robot_settings import RobotSettings
from hal.settings import Settings
from hal.simulation import SimulationFactory
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.batch_exam import BatchExam
from kurt2rt.experiments.lockstep.curriculum import Report, run_drives
from kurt2rt.experiments.lockstep.drive_loop import DriveLoop
from kurt2rt.experiments.lockstep.exam import ExamResult, ExamSetup
from kurt2rt.experiments.lockstep.exam_verdict import ExamVerdict


class Drive(Settings):
    """Drive without a teacher."""

    verdict: ExamVerdict
    """Verdict by the policy's own drive from the same start."""
    duration_s: float
    progress: float
    """Progress by the task's metric, such as laps or m."""
    collisions: int
    stuck: bool
    alarm: str
    share_unknown: float
    """Ratio of ticks in unknown situations, 0 to 1."""
    right_share: float = 0.0
    """Ratio of the junctions that were left as required, 0 to 1; 0 without junctions."""

    @property
    def passed(self) -> bool:
        """True if the drive was judged and passed."""
        return self.verdict is ExamVerdict.PASSED

    @property
    def judged(self) -> bool:
        """True if the policy's own drive is a measure."""
        return self.verdict is not ExamVerdict.NOT_JUDGED


def _drive_of(exam: ExamResult, verdict: ExamVerdict) -> Drive:
    return Drive(
        verdict=verdict,
        duration_s=exam.duration_s,
        progress=exam.progress,
        collisions=exam.collisions,
        stuck=exam.stuck,
        alarm=exam.alarm,
        share_unknown=exam.share_unknown,
        right_share=exam.right_share,
    )


@dataclass(frozen=True, slots=True)
class Examiner:
    """Examiner of one robot in one world, by the policy's own drive from the same start."""

    factory: SimulationFactory
    robot: RobotSettings
    task: TaskSettings
    world: str
    seed: int
    report: Report
    loop: DriveLoop = DriveLoop.BUS

    async def drive_policy(self) -> Drive:
        """Return the policy's own drive; it passes if it has no collision, alarm or standstill.

        Raises SettingsError if task and world do not fit.
        """
        policy = await self._drive(ExamSetup(self.world, self.seed, teacher_policy=True))
        return _drive_of(policy, policy.verdict(policy.progress, self.task.exam.success))

    async def examine(
        self, policy: Drive, events: Sequence[TeachingEvent], learners: LearnerTeam | None = None
    ) -> Drive:
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
        exam = await self._drive(ExamSetup(self.world, self.seed, learners=learners), events)
        if not policy.passed:
            return _drive_of(exam, ExamVerdict.NOT_JUDGED)
        return _drive_of(exam, exam.verdict(policy.progress, self.task.exam.success))

    async def _drive(self, setup: ExamSetup, events: Sequence[TeachingEvent] = ()) -> ExamResult:
        exams = [BatchExam(setup, events)]
        (result,) = await run_drives(self.factory, self.robot, self.task, exams, self.report, self.loop)
        return result
