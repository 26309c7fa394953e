"""The RLA system: a set of RLAs, of which the nearest one inside its radius answers a situation (paper, III).

Where a task teaches several behaviours there is one such system for each, and one history of lessons for all.
"""

import hashlib
from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.rla.lesson_book import LessonBook, LessonRecord
from kurt2rt.rla.matching import ConditionIndex
from kurt2rt.rla.rla import (
    ActionReplaced,
    Condition,
    Lesson,
    LessonUndone,
    Rla,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    SessionBegun,
    SessionEnded,
    TeachingEvent,
)


class Match(NamedTuple):
    """Answer of an RLA system to a situation."""

    rla: Rla
    """The nearest RLA, also when the situation lies outside its radius."""
    distance: float
    radius: float
    runner_up: Rla | None
    runner_up_distance: float
    """Infinite where there is no runner-up."""

    @property
    def known(self) -> bool:
        """Whether the situation lies within the nearest RLA's confidence radius."""
        return self.distance <= self.radius


class Appraisal(NamedTuple):
    """How often teachers praised and blamed what an RLA decided (paper, phase 3)."""

    rewards: int = 0
    punishments: int = 0


class UnfitEventError(ValueError):
    """A teaching event does not fit the knowledge it should change."""


class _Contest:
    """The RLAs of one taught behaviour, by their ids: the same rows as in the index of their conditions."""

    def __init__(self, dimensions: int) -> None:
        self.ids: list[int] = []  # oldest first
        self.index = ConditionIndex(dimensions)

    def enter(self, rla_id: int, condition: tuple[float, ...]) -> None:
        """Put one where its age belongs. Raises ValueError for a wrong length or a number that is not finite."""
        position = bisect_left(self.ids, rla_id)
        self.index.insert(position, condition)
        self.ids.insert(position, rla_id)

    def leave(self, rla_id: int) -> None:
        """Take out one that is there."""
        position = bisect_left(self.ids, rla_id)
        self.index.remove(position)
        del self.ids[position]


class RlaSystem:
    """The fold of teaching events; winner takes all by Euclidean distance, among the RLAs of one taught behaviour."""

    def __init__(self, dimensions: int, radius: float, weights: NDArray[np.float64] | None = None) -> None:
        """`weights`, shape (dimensions,): how much each feature counts in a distance; all count 1 unless given."""
        self.dimensions = dimensions
        self.radius = radius
        self.weights = np.ones(dimensions) if weights is None else weights
        self.teaching_ticks = 0
        """How long all sessions that have ended lasted, together."""
        self._rlas: dict[int, Rla] = {}
        self._contests: dict[str, _Contest] = {}
        self._last_id = 0
        self._appraisals: dict[int, Appraisal] = {}
        self._book = LessonBook()
        self._before: dict[str, Rla] = {}
        """The RLA as it was before a lesson that stands, which replaced its action or deleted it, by command id."""

    def __len__(self) -> int:
        return len(self._rlas)

    @property
    def rlas(self) -> tuple[Rla, ...]:
        """All living RLAs of all behaviours, oldest first."""
        return tuple(self._rlas[rla_id] for rla_id in sorted(self._rlas))

    @property
    def next_id(self) -> int:
        """Id of the next RLA to be taught; ids of deleted or undone RLAs are never given again."""
        return self._last_id + 1

    def get(self, rla_id: int) -> Rla | None:
        """The living RLA of that id."""
        return self._rlas.get(rla_id)

    def appraisal(self, rla_id: int) -> Appraisal:
        """What teachers thought of an RLA; none and none where nobody said so."""
        return self._appraisals.get(rla_id, Appraisal())

    @property
    def lessons(self) -> tuple[LessonRecord, ...]:
        """All lessons, oldest first, those that were undone among them."""
        return self._book.records

    @property
    def standing_lessons(self) -> int:
        """Number of lessons that stand, rewards among them."""
        return self._book.standing

    @property
    def last_standing_lesson(self) -> str | None:
        """Command id of the newest lesson that stands."""
        return self._book.last_standing

    def lesson(self, command_id: str) -> LessonRecord | None:
        """The lesson of that command."""
        return self._book.get(command_id)

    def why_not_undo(self, command_id: str) -> str | None:
        """Why the lesson of that command cannot be undone now, in a sentence; None where it can."""
        return self._book.why_not_undo(command_id)

    def match(self, situation: NDArray[np.float64], behaviour: str = "") -> Match | None:
        """The RLA of a taught behaviour nearest to a situation vector (d,), and the one behind it.

        None when nothing was taught for that behaviour yet.
        """
        contest = self._contests.get(behaviour)
        nearest = None if contest is None else contest.index.nearest(situation * self.weights)
        if contest is None or nearest is None:
            return None
        rla = self._rlas[contest.ids[nearest.position]]
        runner_up = self._rlas[contest.ids[nearest.runner_up]] if nearest.runner_up >= 0 else None
        radius = self.radius if rla.radius is None else rla.radius
        return Match(rla, nearest.distance, radius, runner_up, nearest.runner_up_distance)

    def apply(self, event: TeachingEvent) -> None:
        """Change the knowledge as the event says. Raises UnfitEventError, and changes nothing, when it does not fit."""
        match event:
            case LessonUndone(lesson, _):
                problem = self._book.why_not_undo(lesson)
                if problem is not None:
                    raise UnfitEventError(problem)
                self._take_back(self._book.strike(lesson))
            case SessionBegun():
                pass
            case SessionEnded(lasted_ticks, _):
                self.teaching_ticks += lasted_ticks
            case _:
                command_id = event.origin.command_id
                if self._book.get(command_id) is not None:
                    raise UnfitEventError(f"command {command_id!r} has taught a lesson already")
                self._learn(event)
                self._book.enter(event)

    def apply_all(self, events: Iterable[TeachingEvent]) -> None:
        """Apply events in order."""
        for event in events:
            self.apply(event)

    def knowledge_hash(self) -> str:
        """Fingerprint of what the system knows: ids, behaviours, conditions, actions, radii; not who taught or when."""
        digest = hashlib.sha256()
        for rla in self.rlas:
            of = f"of {rla.behaviour} " if rla.behaviour else ""
            digest.update(f"{rla.rla_id} {of}{rla.action} {rla.radius!r} ".encode())
            digest.update(np.array(rla.condition, dtype=np.float64).tobytes())
        return digest.hexdigest()

    def _learn(self, lesson: Lesson) -> None:
        match lesson:
            case RlaCreated(rla):
                if rla.rla_id <= self._last_id:
                    raise UnfitEventError(f"RLA {rla.rla_id} cannot be created: ids up to {self._last_id} are taken")
                try:
                    self._enter(rla)
                except ValueError as error:
                    raise UnfitEventError(f"RLA {rla.rla_id}: {error}") from error
                self._last_id = rla.rla_id
            case ActionReplaced(rla_id, action, _, origin):
                old = self._living(rla_id)
                self._rlas[rla_id] = replace(old, action=action, origin=origin)
                self._before[origin.command_id] = old
            case RlaDeleted(rla_id, origin):
                self._before[origin.command_id] = self._leave(self._living(rla_id))
            case RlaRewarded(rla_id, value, _, _):
                self._living(rla_id)
                if value not in (1, -1):
                    raise UnfitEventError(f"a reward of {value} for RLA {rla_id}: it must be 1 or -1")
                self._count(rla_id, value, 1)

    def _take_back(self, lesson: Lesson) -> None:
        """Undo a lesson after which nothing that stands happened to its RLA."""
        match lesson:
            case RlaCreated(rla):
                self._leave(self._living(rla.rla_id))
            case ActionReplaced(rla_id, _, _, origin):
                self._living(rla_id)
                self._rlas[rla_id] = self._before.pop(origin.command_id)
            case RlaDeleted(_, origin):
                self._enter(self._before.pop(origin.command_id))
            case RlaRewarded(rla_id, value, _, _):
                self._count(rla_id, value, -1)

    def _count(self, rla_id: int, value: int, more: int) -> None:
        rewards, punishments = self.appraisal(rla_id)
        self._appraisals[rla_id] = (
            Appraisal(rewards + more, punishments) if value > 0 else Appraisal(rewards, punishments + more)
        )

    def _weighted(self, condition: Condition) -> tuple[float, ...]:
        if len(condition) != self.dimensions:
            raise ValueError(f"condition has {len(condition)} values, this system matches {self.dimensions}")
        return tuple((np.array(condition, dtype=np.float64) * self.weights).tolist())

    def _enter(self, rla: Rla) -> None:
        condition = self._weighted(rla.condition)
        contest = self._contests.get(rla.behaviour) or _Contest(self.dimensions)
        contest.enter(rla.rla_id, condition)
        self._contests[rla.behaviour] = contest
        self._rlas[rla.rla_id] = rla

    def _leave(self, rla: Rla) -> Rla:
        self._contests[rla.behaviour].leave(rla.rla_id)
        return self._rlas.pop(rla.rla_id)

    def _living(self, rla_id: int) -> Rla:
        rla = self._rlas.get(rla_id)
        if rla is None:
            raise UnfitEventError(f"there is no RLA {rla_id}; living ones: 1 to {self._last_id}, fewer the deleted")
        return rla
