"""Exams of one stage, and the critic compared with the judge."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass

from behaviors.judges.judge import Judge
from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.exam import ExamResult, ExamSetup, examine
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

    async def teachers(self, worlds: Sequence[str]) -> tuple[ExamOutcome, ...]:
        """Let the teacher's own policy drive in each world; return the outcomes in order.

        Raises SettingsError if task and world do not fit.
        """
        drives = [await self._drive(world, (), None, None, teacher_policy=True) for world in worlds]
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
        outcomes = []
        for world in worlds:
            drive = await self._drive(world, events, saved, autonomous_values, teacher_policy=False)
            verdict = drive.verdict(progress[world], self.task.exam.success)
            outcomes.append(_outcome(drive, succeeded=verdict is ExamVerdict.PASSED))
        return tuple(outcomes)

    async def critic(self, events: Sequence[TeachingEvent], saved: Statistics | None) -> tuple[Judgement, ...]:
        """Drive in the world of the training without learning, and return the opinions of critic and judge.

        `saved`: values that rewards had given; None: none. Raises SettingsError if task and world do not fit.
        """
        assert self.task.judge is not None
        scoring = Scoring(self.task.judge.build())
        await self._drive(
            self.task.teaching.world, events, saved, None, teacher_policy=False, on_record=scoring.on_tick
        )
        return tuple(scoring.judgements)

    async def _drive(
        self,
        world: str,
        events: Sequence[TeachingEvent],
        saved: Statistics | None,
        autonomous_values: Statistics | None,
        *,
        teacher_policy: bool,
        on_record: Callable[[TickRecord], None] = lambda _: None,
    ) -> ExamResult:
        who = "the teacher's own drive" if teacher_policy else "exam without teacher"
        setup = ExamSetup(
            world,
            self.seed,
            teacher_policy,
            saved,
            autonomous_values,
            # A robot without knowledge only stands: its exam need not last.
            stuck_ends=not events and not teacher_policy,
            appraises=True,
            on_tick=lambda record, _metric: on_record(record),
        )
        with closing(self.factory.open(world, self.seed, "exam")) as simulation:
            return await examine(
                simulation,
                self.robot,
                self.task,
                events,
                setup,
                lambda done_s: self.report(f"{who}, world {world}", done_s, self.task.exam.duration_s),
            )


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
