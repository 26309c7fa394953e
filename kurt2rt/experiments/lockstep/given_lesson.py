"""Lesson that was given: its result, and what it taught."""

from collections.abc import Sequence
from dataclasses import dataclass

from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.experiments.lockstep.lesson import TrainingResult


@dataclass(frozen=True, slots=True)
class GivenLesson:
    """Result of a lesson, and what it taught."""

    result: TrainingResult
    events: Sequence[TeachingEvent]
