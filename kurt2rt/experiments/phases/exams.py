"""Exams of one stage, and the critic compared with the judge."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from behaviors.judges.judge import Judge
from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.batch_exam import BatchExam
from kurt2rt.experiments.lockstep.curriculum import Report, run_drives
from kurt2rt.experiments.lockstep.drive_loop import DriveLoop
from kurt2rt.experiments.lockstep.exam import ExamResult, ExamSetup
from kurt2rt.experiments.lockstep.exam_verdict import ExamVerdict
from kurt2rt.experiments.phases.outcome import ExamOutcome, Judgement


class Scoring:
    """Counter of the pairs of opinions of critic and judge, while the robot drives."""

    def __init__(self, judge: Judge) -> None:
        self._judge = judge
        self._ticks: Counter[tuple[int, int | None]] = Counter()

    def on_tick(self, record: TickRecord) -> None:
        """Count the pair of opinions of critic and judge in one tick; call it on every tick."""
        if record.appraisal_features is None or not record.decision.driving:
            return
        said = None if record.opinion is None else record.opinion.said
        self._ticks[self._judge.judge(record.appraisal_features), said] += 1

    @property
    def judgements(self) -> Iterator[Judgement]:
        """Pairs of opinions of judge and critic, each with its number of ticks."""
        for judged, said in sorted(self._ticks, key=str):
            yield Judgement(judged=judged, said=said, ticks=self._ticks[judged, said])


@dataclass(frozen=True, slots=True)
class Examiner:
    """Examiner of one robot; a stuck robot is rescued and drives on."""

    factory: SimulationFactory
    robot: RobotSettings
    task: TaskSettings
    seed: int
    report: Report
    loop: DriveLoop = DriveLoop.BUS
    """Loop of the exams; a batch leaves robots that are rescued to the CAN bus."""

    async def teachers(self, worlds: Sequence[str]) -> tuple[ExamOutcome, ...]:
        """Let the teacher's own policy drive in each world; return the outcomes in order.

        Raises SettingsError if task and world do not fit.
        """
        setups = [ExamSetup(world, self.seed, teacher_policy=True, stuck_ends=False) for world in worlds]
        drives = await self._run([BatchExam(each) for each in setups], self.loop)
        return tuple(_outcome(each, succeeded=not each.failed) for each in drives)

    async def robots(
        self,
        events: Sequence[TeachingEvent],
        saved: Statistics | None,
        worlds: Sequence[str],
        teachers: Sequence[ExamOutcome],
        autonomous_values: Statistics | None = None,
    ) -> tuple[ExamOutcome, ...]:
        """Return the exams of the knowledge in `events`, measured by the teacher's own drives in the same worlds.

        Args:
            events: lessons of the robot.
            saved: values that rewards had given; None: none.
            worlds: of the exams.
            teachers: results of `teachers` for these worlds.
            autonomous_values: values of phase 5; None: none.

        Raises:
            SettingsError: task and world do not fit.
            UnknownActionError, UnknownBehaviourError: the knowledge does not fit the task.
        """
        progress = {each.world: each.progress for each in teachers}
        exams = [self._exam(world, events, saved, autonomous_values) for world in worlds]
        drives = await self._run(exams, self.loop)
        verdicts = [each.verdict(progress[each.world], self.task.exam.success) for each in drives]
        return tuple(
            _outcome(drive, succeeded=verdict is ExamVerdict.PASSED)
            for drive, verdict in zip(drives, verdicts, strict=True)
        )

    async def critic(self, events: Sequence[TeachingEvent], saved: Statistics | None) -> tuple[Judgement, ...]:
        """Drive in the world of the training without learning, and return the opinions of critic and judge.

        `saved`: values that rewards had given; None: none. Raises SettingsError if task and world do not fit.
        """
        assert self.task.judge is not None
        scoring = Scoring(self.task.judge.build())
        exam = self._exam(self.task.teaching.world, events, saved, None)
        setup = replace(exam.setup, appraises=True, on_tick=lambda record, _metric: scoring.on_tick(record))
        # A batch has no record of each tick.
        await self._run([replace(exam, setup=setup)], DriveLoop.BUS)
        return tuple(scoring.judgements)

    def _exam(
        self,
        world: str,
        events: Sequence[TeachingEvent],
        saved: Statistics | None,
        autonomous_values: Statistics | None,
    ) -> BatchExam:
        # A robot without knowledge only stands: its exam need not last.
        setup = ExamSetup(world, self.seed, saved=saved, autonomous_values=autonomous_values, stuck_ends=not events)
        return BatchExam(setup, events)

    async def _run(self, exams: Sequence[BatchExam], loop: DriveLoop) -> list[ExamResult]:
        return await run_drives(self.factory, self.robot, self.task, exams, self.report, loop)


def _outcome(exam: ExamResult, *, succeeded: bool) -> ExamOutcome:
    return ExamOutcome(
        world=exam.world,
        unit=exam.unit,
        progress=exam.progress,
        duration_s=exam.duration_s,
        way_m=exam.distance_travelled_m,
        collisions=exam.collisions,
        rescues=max(exam.rescues, int(exam.stuck)),
        alarm=exam.alarm,
        share_unknown=exam.share_unknown,
        action_changes_per_s=exam.action_changes_per_s,
        findings={name: float(value) for name, value in exam.findings.items()},
        succeeded=succeeded,
    )
