"""What is kept of a lesson."""

from collections.abc import Iterable

from kurt2rt.core.rla.rla import CRITIC, ActionWithdrawn, LessonUndone, TeachingEvent
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.phases.outcome import TeachingOutcome


def told(lesson: TrainingResult, events: Iterable[TeachingEvent]) -> TeachingOutcome:
    """`events`: those that the lesson brought."""
    events = tuple(events)
    own = [event for event in events if event.origin.teacher == CRITIC]
    undone = sum(isinstance(event, LessonUndone) for event in own)
    return TeachingOutcome(
        duration_s=lesson.teaching_s,
        load=lesson.workload,
        asks=lesson.asks,
        praise=lesson.positive_rewards,
        blame=lesson.negative_rewards,
        refused_signals=lesson.refused_signals,
        collisions=lesson.collisions,
        rescues=lesson.rescues,
        unknown_rescues=lesson.unknown_rescues,
        alarms=lesson.alarms,
        share_unknown=lesson.share_unknown,
        agreement=lesson.agreement,
        share_trusted=lesson.share_trusted,
        withdrawn=sum(isinstance(event, ActionWithdrawn) for event in events),
        critics_changes=len(own) - undone,
        rolled_back=undone,
    )
