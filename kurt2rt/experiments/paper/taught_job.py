"""One robot: taught by the scripted teacher, then examined."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import anyio

from hal.robot_settings import RobotSettings
from hal.simulation import Position, SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import WorldResult, run_exams, run_lesson
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.paper.outcome import DriveOutcome, Place, Reading, TaughtOutcome
from kurt2rt.experiments.study.pool import Tell
from kurt2rt.experiments.study.progress_sum import ProgressSum
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.study.results import Results

_PLACE_STRIDE = 2
"""Points of a drive's trail from one that is kept to the next: 0.2 s."""


@dataclass(frozen=True, slots=True)
class TaughtJob:
    """One task, one reading of the paper, one seed."""

    stage: SimulationFactory
    robot: RobotSettings
    task: TaskSettings
    reading: Reading
    seed: int
    unseen: tuple[str, ...]
    """Generated worlds that this robot drives in, besides those of the task."""
    made_of: Provenance
    results: Results

    @property
    def name(self) -> str:
        """What is shown while it runs."""
        return f"{self.task.name}, seed {self.seed}" + (", plain" if self.reading == "plain" else "")

    @property
    def file(self) -> str:
        """Path within the folder of results."""
        return f"results/{self.reading}/{self.task.name}-{self.seed}.json"

    @property
    def worlds(self) -> tuple[str, ...]:
        """Worlds of its exams."""
        return (*self.task.exam.worlds, *self.unseen)

    @property
    def outcome(self) -> type[TaughtOutcome]:
        """Schema of its result."""
        return TaughtOutcome

    @property
    def robot_time_s(self) -> float:
        """The lesson; and in each world the exam and the teacher's own drive."""
        return self.task.teaching.duration_s + 2 * len(self.worlds) * self.task.exam.duration_s

    def run(self, tell: Tell) -> None:
        """Teach, examine, keep the result and the knowledge."""
        anyio.run(self._run, tell)

    async def _run(self, tell: Tell) -> None:
        report = ProgressSum(tell).report
        stage, robot, task, seed = self.stage, self.robot, self.task, self.seed
        with self.results.scratch() as folder:
            knowledge = folder / "knowledge"
            lesson, events = await run_lesson(stage, robot, task, knowledge, seed=seed, report=report)
            exams = await run_exams(stage, robot, task, events, self.worlds, seed=seed, report=report)
            self.results.keep(knowledge, f"knowledge/{self.reading}/{task.name}-{seed}.knowledge")
        self.results.write(self, self._outcome(lesson, exams))

    def _outcome(self, lesson: TrainingResult, exams: Iterable[WorldResult]) -> TaughtOutcome:
        of = Counter(rla.behaviour for rla in lesson.rlas)
        several = len(self.task.behaviours) > 1
        return TaughtOutcome(
            made_of=self.made_of,
            seed=self.seed,
            teaching_s=lesson.teaching_s,
            rlas=len(lesson.rlas),
            rlas_of={name: of[name] for name in self.task.behaviours} if several else {},
            knowledge_hash=lesson.knowledge_hash,
            asks=lesson.asks,
            corrections=lesson.corrections,
            rescues=lesson.rescues,
            alarms=lesson.alarms,
            drives=tuple(map(_drive, exams)),
        )


def _drive(each: WorldResult) -> DriveOutcome:
    exam = each.learned
    return DriveOutcome(
        world=exam.world,
        unit=exam.unit,
        progress=exam.progress,
        teachers_progress=each.teacher.progress,
        teachers_collisions=each.teacher.collisions,
        teachers_stuck=each.teacher.stuck,
        teachers_alarm=each.teacher.alarm,
        succeeded=each.succeeded,
        duration_s=exam.duration_s,
        way_m=exam.distance_travelled_m,
        collisions=exam.collisions,
        stuck=exam.stuck,
        alarm=exam.alarm,
        share_unknown=exam.share_unknown,
        findings={name: float(value) for name, value in exam.findings.items()},
        trail=_places(exam.trail[::_PLACE_STRIDE]),
        asked_at=_places(exam.unknown_positions),
        collided_at=_places(exam.collision_positions),
        least_progress=exam.least_progress,
    )


def _places(positions: Iterable[Position]) -> tuple[Place, ...]:
    return tuple((round(each.x_m, 3), round(each.y_m, 3)) for each in positions)
