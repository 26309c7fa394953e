"""Row of a drive without a teacher, which all studies store, and the examiner of a taught robot."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from behaviors.metrics.task_metric import JUNCTIONS, RIGHT
from hal.robot_settings import RobotSettings
from hal.settings import Settings
from hal.simulation import Position, SimulationFactory
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.batch_exam import BatchExam
from kurt2rt.experiments.lockstep.curriculum import Report, WorldResult, run_drives
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.experiments.lockstep.exam import ExamResult, ExamSetup
from kurt2rt.experiments.lockstep.exam_verdict import ExamVerdict
from kurt2rt.experiments.study.intervals import Rate, rate_of

_PLACE_STRIDE = 2
"""Points of a trail, 0.1 s apart, from one that is stored to the next."""
TEN_MIN_S = 600.0
Place = tuple[float, float]
"""x and y in m, to the millimetre."""


class DriveRow(Settings):
    """Drive without a teacher."""

    world: str
    verdict: ExamVerdict
    """Verdict by the drive of the teacher's policy from the same start."""
    duration_s: float
    unit: str
    progress: float
    """Progress by the task's metric, in `unit`."""
    least_progress: float = 0.0
    """A drive that comes no farther gets nowhere."""
    way_m: float
    collisions: int
    stuck: bool
    rescues: int = 0
    """Number of times the robot was stuck, if that does not end the drive."""
    alarm: str
    """Reason of the guard's latched stop, which ends the drive; empty without one."""
    share_unknown: float
    """Ratio of ticks in unknown situations, 0 to 1."""
    action_changes_per_s: float
    findings: dict[str, float]
    """Further measures of the task's metric, by name."""
    teacher: "DriveRow | None" = None
    """Drive of the teacher's policy; None where it is stored elsewhere."""
    trail: tuple[Place, ...] = ()
    """Points 0.2 s apart; it and the next two are empty if no picture is drawn."""
    asked_at: tuple[Place, ...] = ()
    collided_at: tuple[Place, ...] = ()

    @property
    def passed(self) -> bool:
        """True if the drive was judged and passed."""
        return self.verdict is ExamVerdict.PASSED

    @property
    def judged(self) -> bool:
        """True if the policy's own drive is a measure."""
        return self.verdict is not ExamVerdict.NOT_JUDGED

    @property
    def failed(self) -> bool:
        """True if the drive collided, got stuck or was stopped by the guard for good."""
        return self.collisions > 0 or self.ended_early

    @property
    def ended_early(self) -> bool:
        """True if the robot was stuck, or stopped by the guard for good."""
        return self.stuck or self.rescues > 0 or bool(self.alarm)

    @property
    def early_end(self) -> str:
        """Why and when the drive ended before its time; empty if it did not."""
        why = self.alarm or ("stuck" if self.stuck else "")
        return f"{why} after {self.duration_s:.0f} s" if why else ""

    @property
    def got_nowhere(self) -> bool:
        """True if the progress is too small to measure another drive by."""
        return self.progress <= self.least_progress

    @property
    def junctions(self) -> int:
        """Number of junctions that the robot was asked at."""
        return round(self.findings.get(JUNCTIONS, 0.0))

    @property
    def right(self) -> int:
        """Number of junctions that were left as asked."""
        return round(self.findings.get(RIGHT, 0.0))

    @property
    def right_share(self) -> float:
        """Ratio of the junctions that were left as asked, 0 to 1; 0 without junctions."""
        return self.right / self.junctions if self.junctions else 0.0


def row_of(exam: ExamResult, verdict: ExamVerdict, *, trails: bool = False) -> DriveRow:
    """Return the row of an exam. `trails`: with its places, for a picture."""
    return DriveRow(
        world=exam.world,
        verdict=verdict,
        duration_s=exam.duration_s,
        unit=exam.unit,
        progress=exam.progress,
        least_progress=exam.least_progress,
        way_m=exam.distance_travelled_m,
        collisions=exam.collisions,
        stuck=exam.stuck,
        rescues=exam.rescues,
        alarm=exam.alarm,
        share_unknown=exam.share_unknown,
        action_changes_per_s=exam.action_changes_per_s,
        findings={name: float(value) for name, value in exam.findings.items()},
        trail=rounded_places(exam.trail[::_PLACE_STRIDE]) if trails else (),
        asked_at=rounded_places(exam.unknown_positions) if trails else (),
        collided_at=rounded_places(exam.collision_positions) if trails else (),
    )


def row_with_teacher(result: WorldResult) -> DriveRow:
    """Return the row of an exam with its places and the drive of the teacher's policy."""
    teacher = row_of(result.teacher, ExamVerdict.FAILED if result.teacher.failed else ExamVerdict.PASSED)
    return row_of(result.learned, result.verdict, trails=True).model_copy(update={"teacher": teacher})


def rounded_places(positions: Iterable[Position | Place]) -> tuple[Place, ...]:
    """Return positions in m, rounded to the millimetre."""
    return tuple((round(x_m, 3), round(y_m, 3)) for x_m, y_m in positions)


def collisions_in_10_min(drives: Sequence[DriveRow]) -> Rate:
    """Return the collisions in 10 min of driving over all drives together, with the 95 % interval."""
    return rate_of([each.collisions for each in drives], [each.duration_s / TEN_MIN_S for each in drives])


def right_rate(drives: Sequence[DriveRow]) -> Rate | None:
    """Return the share of the junctions of all drives that were left as asked, with its interval; None without any."""
    asked = [each for each in drives if each.junctions]
    if not asked:
        return None
    # Of the wrong ones, so that the interval of robots that never err does not shrink to a point.
    errs = rate_of([each.junctions - each.right for each in asked], [each.junctions for each in asked])
    return Rate(1 - errs.value, max(0.0, 1 - errs.high), 1 - errs.low)


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
        return row_of(policy, policy.verdict(policy.progress, self.task.exam.success))

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
        exam = await self._drive(ExamSetup(self.world, self.seed, learners=learners), events)
        if not policy.passed:
            return row_of(exam, ExamVerdict.NOT_JUDGED)
        return row_of(exam, exam.verdict(policy.progress, self.task.exam.success))

    async def _drive(self, setup: ExamSetup, events: Sequence[TeachingEvent] = ()) -> ExamResult:
        exams = [BatchExam(setup, events)]
        (result,) = await run_drives(self.factory, self.robot, self.task, exams, self.report, self.engine)
        return result
