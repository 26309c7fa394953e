"""Undo of the last lesson: the processor time that it takes, and whether all decisions are those of before."""

import time
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.learner.learner import Label, Signal
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.rla.events import LessonRedone, LessonUndone, RlaCreated, TeachingEvent
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.rla import BASIC, Origin
from kurt2rt.core.rla.rla_system import RlaSystem


class Undo(NamedTuple):
    """Undo of a last lesson."""

    seconds: float
    restores: bool


_Place = tuple[str, NDArray[np.float64]]
"""Behaviour, and situation (d,)."""


def undo_of_learner(taught: LearnerTeam, other: LearnerTeam) -> Undo:
    """Undo the last label of a team, and compare with learners that were never taught it.

    `other`: learners of the same kind that know nothing yet.
    """
    lessons = taught.lessons
    if not lessons:
        return Undo(0.0, True)
    last = lessons[-1]
    places = [(lesson.behaviour, _situation(lesson)) for lesson in lessons]
    other.teach_all(lesson for lesson in lessons if lesson.command_id != last.command_id)
    began_s = time.thread_time()
    taught.undo(last.command_id)
    taught.decide(last.behaviour, _situation(last), taught=False)
    seconds = time.thread_time() - began_s
    return Undo(seconds, _decisions(taught, places) == _decisions(other, places))


def undo_of_rlas(system: RlaSystem, other: RlaSystem, events: Sequence[TeachingEvent]) -> Undo:
    """Undo the last standing lesson of an RLA system, and compare with RLAs that were never taught it.

    `other`: an empty system of the same task. `events`: all lessons of `system`, oldest first.
    """
    last = system.last_standing_lesson
    places = [
        (event.rla.behaviour, np.array(event.rla.condition))
        for event in events
        if isinstance(event, RlaCreated) and event.rla.level == BASIC
    ]
    if last is None or not places:
        return Undo(0.0, True)
    system.radius_share = other.radius_share  # the robot was taught until now, and asked sooner
    other.apply_all(event for event in events if _stands_without(last, event, system))
    began_s = time.thread_time()
    system.apply(LessonUndone(last, Origin("undo", "", Phase.CORRECTIONS, 0)))
    _choice(system, places[-1])
    seconds = time.thread_time() - began_s
    return Undo(seconds, all(_choice(system, place) == _choice(other, place) for place in places))


def _stands_without(last: str, event: TeachingEvent, system: RlaSystem) -> bool:
    """Return whether an event is left where the last lesson, and each undone one with its undo, never was.

    An undone lesson may be about an RLA that the last standing lesson created, so it cannot be learnt without that.
    """
    if isinstance(event, LessonUndone | LessonRedone):
        return False
    lesson = system.lesson(event.origin.command_id)
    return lesson is None or not (lesson.undone or event.origin.command_id == last)


def _situation(lesson: Label | Signal) -> NDArray[np.float64]:
    """Return the situation (d,) of a label, or that of the newest tick of a reward."""
    return lesson.situation if isinstance(lesson, Label) else lesson.driven[0].situation


def _decisions(team: LearnerTeam, places: Sequence[_Place]) -> list[str | None]:
    return [team.decide(behaviour, situation, taught=False) for behaviour, situation in places]


def _choice(system: RlaSystem, place: _Place) -> str | None:
    behaviour, situation = place
    match = system.match(situation, behaviour, include_withdrawn=False)
    return match.rla.action if match is not None and match.known else None
