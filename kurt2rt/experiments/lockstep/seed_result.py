"""Numbers of one robot's training run and exams, without knowledge and trails."""

from dataclasses import replace

from hal.settings import Settings
from kurt2rt.experiments.lockstep.curriculum import CurriculumResult, WorldResult
from kurt2rt.experiments.lockstep.exam import ExamResult
from kurt2rt.experiments.lockstep.lesson import TrainingResult

TRAILS = ("trail", "unknown_positions", "collision_positions")
"""Fields of an exam that are for pictures."""


class LessonCounts(Settings):
    """Counts of one training run."""

    seed: int
    world: str
    teacher: str
    """Name of the scripted teacher."""
    teaching_s: float
    rlas: int
    knowledge_hash: str
    asks: int
    corrections: int
    presses: int
    rescues: int
    repositions: int
    deletions: int
    alarms: int
    collisions: int


class SeedResult(Settings):
    """Counts of a training run, and exams without trails."""

    lesson: LessonCounts
    exams: tuple[WorldResult, ...]


def counts_of(lesson: TrainingResult) -> LessonCounts:
    """Return the counts of a training run."""
    counted = {name: getattr(lesson, name) for name in LessonCounts.model_fields if name != "rlas"}
    return LessonCounts(rlas=len(lesson.rlas), **counted)


def seed_result(result: CurriculumResult) -> SeedResult:
    """Return the numbers of a training run and its exams."""
    return SeedResult(lesson=counts_of(result.lesson), exams=tuple(map(_without_trails, result.exams)))


def _without_trails(exam: WorldResult) -> WorldResult:
    return replace(exam, learned=_trimmed(exam.learned), teacher=_trimmed(exam.teacher))


def _trimmed(exam: ExamResult) -> ExamResult:
    """Return the exam without `TRAILS`."""
    findings = {name: float(value) for name, value in exam.findings.items()}
    return replace(exam, findings=findings, trail=(), unknown_positions=(), collision_positions=())
