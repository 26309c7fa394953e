"""Lesson that was given: its result, and what it taught."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.experiments.lockstep.drive_loop import BatchDiffersError
from kurt2rt.experiments.lockstep.lesson import TrainingResult


@dataclass(frozen=True, slots=True)
class GivenLesson:
    """Result of a lesson, and what it taught."""

    result: TrainingResult
    events: Sequence[TeachingEvent]


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
