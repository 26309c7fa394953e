"""Choice of the loop that drives lessons: the CAN bus, or a batch with witnesses on the CAN bus."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.experiments.lockstep.exam_driver import BatchDiffersError, DriveLoop, choose_witnesses
from kurt2rt.experiments.lockstep.lesson import TrainingResult


@dataclass(frozen=True, slots=True)
class LessonDriver:
    """Loop of one lesson."""

    loop: DriveLoop = DriveLoop.BUS
    is_witnessed: bool = False
    """Give a lesson of the batch on the CAN bus too; both must be equal."""


LESSON_ON_BUS = LessonDriver()


@dataclass(frozen=True, slots=True)
class GivenLesson:
    """Result of a lesson, and what it taught."""

    result: TrainingResult
    events: Sequence[TeachingEvent]


def choose_lesson_drivers(loop: DriveLoop, lessons: int) -> list[LessonDriver]:
    """Return the driver of each lesson of a study: 1 % of them, at least three, have a witness."""
    if loop is DriveLoop.BUS:
        return [LESSON_ON_BUS] * lessons
    witnesses = set(choose_witnesses(range(lessons), f"{lessons} lessons"))
    return [LessonDriver(loop, place in witnesses) for place in range(lessons)]


def require_equal_lessons(batch: GivenLesson, bus: GivenLesson) -> None:
    """Check that a lesson in the batch had the course and the knowledge of the CAN bus. Raises BatchDiffersError."""
    # The counter of uses has no equality of its own; the saved statistics hold its counts.
    compared = [each.name for each in fields(TrainingResult) if each.compare and each.name != "statistics"]
    differing = [name for name in (*compared, "saved") if getattr(batch.result, name) != getattr(bus.result, name)]
    if list(batch.events) != list(bus.events):
        differing.append("lessons")
    if differing:
        raise BatchDiffersError(
            f"the batch and the CAN bus differ in {', '.join(differing)}; all results of the batch are refused",
            where=f"lesson in world {bus.result.world}, seed {bus.result.seed}",
            do="report it, and give --lessons bus",
        )
