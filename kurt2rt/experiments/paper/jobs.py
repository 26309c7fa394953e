"""Jobs of the paper's study: a taught and examined robot, and a curve of Fig. 2."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from hal.simulation import Position
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report, WorldResult, run_exams, run_lesson
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.paper.outcome import DriveOutcome, GrowthOutcome, Place, Reading, TaughtOutcome
from kurt2rt.experiments.study.jobs import StudyJob

_PLACE_STRIDE = 2
"""Points of a trail, 0.1 s apart, from one that is stored to the next."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TaughtJob(StudyJob):
    """Robot of one task, one reading of the paper and one seed, taught and examined."""

    outcome = TaughtOutcome
    gives_lesson: ClassVar[bool] = True
    gives_exams: ClassVar[bool] = True
    reading: Reading
    unseen: tuple[str, ...]
    """Generated worlds of this robot's exams, besides those of the task."""

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name}, seed {self.seed}" + (", plain" if self.reading == "plain" else "")

    @property
    def stem(self) -> str:
        """Path of result and knowledge, without the top folder and the ending."""
        return f"{self.reading}/{self.task.name}-{self.seed}"

    @property
    def worlds(self) -> tuple[str, ...]:
        """Worlds of the exams."""
        return (*self.task.exam.worlds, *self.unseen)

    @property
    def robot_time_s(self) -> float:
        """Time of the training run, and of two drives in each world, in s."""
        return self.task.teaching.duration_s + 2 * len(self.worlds) * self.task.exam.duration_s

    async def measure(self, knowledge: Path, report: Report) -> TaughtOutcome:
        """Teach the task into the file `knowledge`, examine it in each world and return the outcome.

        Raises KnowledgeError, SettingsError, LessonLostError.
        """
        factory, robot, task, seed, loops = self.factory, self.robot, self.task, self.seed, self.loops
        lesson, events = await run_lesson(factory, robot, task, knowledge, seed=seed, report=report, loop=loops.lesson)
        exams = await run_exams(factory, robot, task, events, self.worlds, seed=seed, report=report, loop=loops.exams)
        return self._outcome(lesson, exams)

    def _outcome(self, lesson: TrainingResult, exams: Iterable[WorldResult]) -> TaughtOutcome:
        counts = Counter(rla.behaviour for rla in lesson.rlas)
        several = len(self.task.behaviours) > 1
        return TaughtOutcome(
            made_of=self.made_of,
            seed=self.seed,
            teaching_s=lesson.teaching_s,
            rlas=len(lesson.rlas),
            rlas_of={name: counts[name] for name in self.task.behaviours} if several else {},
            knowledge_hash=lesson.knowledge_hash,
            asks=lesson.asks,
            corrections=lesson.corrections,
            rescues=lesson.rescues,
            alarms=lesson.alarms,
            drives=tuple(map(_drive, exams)),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class GrowthJob(StudyJob):
    """Robot of one confidence radius, taught in phase 1 only: a curve of Fig. 2."""

    outcome = GrowthOutcome
    keeps_knowledge: ClassVar[bool] = False
    gives_lesson: ClassVar[bool] = True
    reading: Reading

    @property
    def radius(self) -> float:
        """Confidence radius R in counts."""
        return self.task.learning.radius

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"growth at R {self.radius:g}, seed {self.seed}" + (", plain" if self.reading == "plain" else "")

    @property
    def stem(self) -> str:
        """Path of the result, without the top folder and the ending."""
        return f"{self.reading}/growth-{self.task.name}-R{self.radius:g}-{self.seed}"

    @property
    def robot_time_s(self) -> float:
        """Time of the training run in s."""
        return self.task.teaching.duration_s

    async def measure(self, knowledge: Path, report: Report) -> GrowthOutcome:
        """Teach the task in phase 1 into the file `knowledge` and return the number of RLAs after each second.

        Raises KnowledgeError, SettingsError, LessonLostError.
        """
        lesson, _ = await run_lesson(
            self.factory,
            self.robot,
            self.task,
            knowledge,
            seed=self.seed,
            report=report,
            loop=self.loops.lesson,
        )
        return GrowthOutcome(made_of=self.made_of, seed=self.seed, radius=self.radius, growth=lesson.growth)


def with_radius_only(task: TaskSettings, radius: float, duration_s: float) -> TaskSettings:
    """Return the task with this radius in counts, taught in phase 1 only for `duration_s`."""
    learning = task.learning.model_copy(update={"radius": radius})
    teaching = task.teaching.model_copy(update={"supervised_s": duration_s, "corrections_s": 0.0})
    return task.model_copy(update={"learning": learning, "teaching": teaching})


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
