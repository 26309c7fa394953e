"""Marks of a lesson: what the robot knew after given numbers of presses."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from kurt2rt.core.learner.learner import Label, Signal
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.rla.events import TeachingEvent


@dataclass(frozen=True, slots=True)
class Mark:
    """Knowledge after a number of presses."""

    presses: int
    """Number asked for; a robot that gave cause for fewer has all that it was taught."""
    events: tuple[TeachingEvent, ...]
    """Lessons so far, which are the knowledge of RLAs."""
    lessons: tuple[Label | Signal, ...]
    """Standing labels and rewards so far, which are the knowledge of a learner; empty for RLAs."""
    teaching_s: float


class PressMarks:
    """Marks of one lesson."""

    def __init__(
        self, after: Sequence[int], events: Callable[[], Sequence[TeachingEvent]], team: LearnerTeam | None
    ) -> None:
        """Mark the knowledge before the press that follows each of `after`, which ascend.

        `events`: returns all lessons so far. `team`: learners that are taught; None: the RLAs.
        """
        self._after, self._events, self._team = after, events, team
        self._marks: list[Mark] = []

    def update(self, presses: int, teaching_s: float) -> None:
        """Mark the knowledge if a press too many was sent, which a later tick applies.

        Args:
            presses: number that was sent so far.
            teaching_s: time of teaching so far, in s.
        """
        while len(self._marks) < len(self._after) and presses > self._after[len(self._marks)]:
            self._marks.append(self._mark(self._after[len(self._marks)], teaching_s))

    def at_end(self, presses: int, teaching_s: float) -> tuple[Mark, ...]:
        """Return all marks and that of the end; those that were not reached are of the end, too."""
        missing = (*self._after[len(self._marks) :], presses)
        return (*self._marks, *(self._mark(each, teaching_s) for each in missing))

    def _mark(self, presses: int, teaching_s: float) -> Mark:
        lessons = () if self._team is None else self._team.lessons
        return Mark(presses, tuple(self._events()), lessons, teaching_s)
