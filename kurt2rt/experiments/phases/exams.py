"""Exams of one stage."""

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass

from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.rla.rla import TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick import TickRecord
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.exam import ExamResult, examine
from kurt2rt.experiments.lockstep.exam_verdict import ExamVerdict
from kurt2rt.experiments.phases.outcome import ExamOutcome, Judgement
from kurt2rt.experiments.phases.scoring import Scoring


@dataclass(frozen=True, slots=True)
class Examiner:
    """Examines one robot; a robot that gets stuck is set down elsewhere and goes on."""

    stage: SimulationFactory
    robot: RobotSettings
    task: TaskSettings
    seed: int
    report: Report

    async def teachers(self, worlds: Sequence[str]) -> tuple[ExamOutcome, ...]:
        """Drives of the teacher's own policy."""
        drives = [await self._drive(world, (), None, None, by_teacher=True) for world in worlds]
        return tuple(_outcome(each, succeeded=not each.failed) for each in drives)

    async def robots(
        self,
        events: Sequence[TeachingEvent],
        saved: Statistics | None,
        worlds: Sequence[str],
        teachers: Sequence[ExamOutcome],
        alone: Statistics | None = None,
    ) -> tuple[ExamOutcome, ...]:
        """Exams with what `events` have taught, measured by the teacher's own drives in the same worlds.

        `saved`, `alone`: what rewards had made of it, and phase 5.
        """
        progress = {each.world: each.progress for each in teachers}
        outcomes = []
        for world in worlds:
            drive = await self._drive(world, events, saved, alone, by_teacher=False)
            verdict = drive.verdict(progress[world], self.task.exam.success)
            outcomes.append(_outcome(drive, succeeded=verdict is ExamVerdict.PASSED))
        return tuple(outcomes)

    async def critic(self, events: Sequence[TeachingEvent], saved: Statistics | None) -> tuple[Judgement, ...]:
        """A drive in the world that is taught in, by what `events` taught, in which the judge judges the critic.

        Nothing is learnt in it.
        """
        assert self.task.judge is not None
        scoring = Scoring(self.task.judge.build())
        await self._drive(self.task.teaching.world, events, saved, None, by_teacher=False, on_record=scoring.look)
        return tuple(scoring.judgements)

    async def _drive(
        self,
        world: str,
        events: Sequence[TeachingEvent],
        saved: Statistics | None,
        alone: Statistics | None,
        *,
        by_teacher: bool,
        on_record: Callable[[TickRecord], None] = lambda _: None,
    ) -> ExamResult:
        who = "the teacher's own drive" if by_teacher else "exam without teacher"
        with closing(self.stage.open(world, self.seed, "exam")) as simulation:
            return await examine(
                simulation,
                self.robot,
                self.task,
                world,
                events,
                seed=self.seed,
                on_progress=lambda done_s: self.report(f"{who}, world {world}", done_s, self.task.exam.duration_s),
                by_teacher=by_teacher,
                saved=saved,
                alone=alone,
                on_record=on_record,
                # A robot that knows nothing only stands, and that is soon seen.
                stuck_ends=not events and not by_teacher,
            )


def _outcome(exam: ExamResult, *, succeeded: bool) -> ExamOutcome:
    return ExamOutcome(
        world=exam.world,
        unit=exam.unit,
        progress=exam.progress,
        duration_s=exam.duration_s,
        way_m=exam.way_m,
        collisions=exam.collisions,
        rescues=max(exam.rescues, int(exam.stuck)),
        alarm=exam.alarm,
        share_unknown=exam.share_unknown,
        action_changes_per_s=exam.action_changes_per_s,
        findings={name: float(value) for name, value in exam.findings.items()},
        succeeded=succeeded,
    )
