"""The RLA system: a set of RLAs, of which the nearest one inside its radius answers a situation (paper, III).

Where a task teaches several behaviours there is one such system for each, and where there is a critic one more for it
(its level); ids and the history of lessons run through all of them.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.rla.competitors import CompetitorGroups
from kurt2rt.rla.condition import Condition
from kurt2rt.rla.contest import Contest
from kurt2rt.rla.fingerprint import knowledge_hash_of
from kurt2rt.rla.lesson_book import LessonBook, LessonRecord
from kurt2rt.rla.named_situations import NamedSituations
from kurt2rt.rla.rla import (
    ASK,
    BASIC,
    ActionReplaced,
    ActionWithdrawn,
    Appraised,
    KnowledgeMerged,
    Lesson,
    LessonRedone,
    LessonUndone,
    Origin,
    Rla,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    SessionBegun,
    SessionEnded,
    SituationNamed,
    TeachingEvent,
)
from kurt2rt.rla.space import Space


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
        """Whether the situation lies within the nearest RLA's confidence radius, and that one has an action."""
        return self.distance <= self.radius and not self.rla.asks


class Appraisal(NamedTuple):
    """How often teachers praised and blamed what an RLA decided (paper, phase 3)."""

    rewards: int = 0
    punishments: int = 0


class UnfitEventError(ValueError):
    """A teaching event does not fit the knowledge it should change."""


class RlaSystem:
    """The fold of teaching events; winner takes all by distance, among the RLAs of one taught behaviour."""

    def __init__(
        self,
        dimensions: int,
        radius: float,
        weights: NDArray[np.float64] | None = None,
        *,
        others: Mapping[str, Space] | None = None,
    ) -> None:
        """`weights`, shape (dimensions,): how much each feature counts in a distance; all count 1 unless given.

        `others`: the spaces of further levels, by name. RLAs of a level that is not among them are kept and can be
        undone, but nothing is matched with them: a robot without a critic can go on with knowledge that has one.
        """
        self.dimensions = dimensions
        self.radius = radius
        self.weights = np.ones(dimensions) if weights is None else weights
        self.teaching_ticks = 0
        """How long all sessions that have ended lasted, together."""
        self.changes = 0
        """How many events were applied: while it stays as it is, equal situations have equal answers."""
        self._spaces = {**(others or {}), BASIC: Space(dimensions, radius, self.weights)}
        self._rlas: dict[int, Rla] = {}
        self._contests: dict[tuple[str, str], Contest] = {}
        """By level and behaviour."""
        self._groups = CompetitorGroups()
        self._count_at: Counter[str] = Counter()
        self._last_id = 0
        self._appraisals: dict[int, Appraisal] = {}
        self._names = NamedSituations()
        self._book = LessonBook()
        self._before: dict[str, Rla] = {}
        """The RLA as it was before a lesson that stands, which changed its action or deleted it, by command id."""

    def __len__(self) -> int:
        return self._count_at[BASIC]

    @property
    def rlas(self) -> tuple[Rla, ...]:
        """All living RLAs of the basic level, of all behaviours, oldest first."""
        return self.rlas_at(BASIC)

    def rlas_at(self, level: str) -> tuple[Rla, ...]:
        """All living RLAs of a level, of all behaviours, oldest first."""
        return tuple(rla for rla in self._all_rlas() if rla.level == level)

    @property
    def living(self) -> tuple[Rla, ...]:
        """All living RLAs of all levels, in no order: a copy that costs a tick next to nothing."""
        return tuple(self._rlas.values())

    @property
    def next_id(self) -> int:
        """Id of the next RLA to be taught; ids of deleted or undone RLAs are never given again."""
        return self._last_id + 1

    def get(self, rla_id: int) -> Rla | None:
        """The living RLA of that id, of whatever level."""
        return self._rlas.get(rla_id)

    def named_at(self, level: str) -> Mapping[str, Condition]:
        """The situations of a level that teachers gave names to, by name."""
        return self._names.at(level)

    def appraisal(self, rla_id: int) -> Appraisal:
        """What teachers thought of an RLA; none and none where nobody said so."""
        return self._appraisals.get(rla_id, Appraisal())

    @property
    def lessons(self) -> tuple[LessonRecord, ...]:
        """All lessons, oldest first, those that were undone among them."""
        return self._book.records

    def lessons_about(self, rla_id: int) -> tuple[LessonRecord, ...]:
        """All lessons about one RLA, oldest first, those that were undone among them."""
        return self._book.about(rla_id)

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

    @property
    def last_undone_lesson(self) -> str | None:
        """Command id of the lesson that was undone last and does not stand again."""
        return self._book.last_undone

    def why_not_redo(self, command_id: str) -> str | None:
        """Why the lesson of that command, taken back, cannot stand again now, in a sentence; None where it can."""
        return self._book.why_not_redo(command_id)

    def comes_back(self, command_id: str) -> Rla | None:
        """The RLA as it will be when the lesson of that command is undone; None where no action comes back by that."""
        return self._before.get(command_id)

    def match(
        self, situation: NDArray[np.float64], behaviour: str = "", level: str = BASIC, *, asking: bool = True
    ) -> Match | None:
        """The RLA of a level and taught behaviour nearest to a situation vector (d,), and the one behind it.

        None when nothing was taught there yet; all are infinitely far from a situation that holds NaN. `asking`: False
        passes over those that ask, for nobody is there.
        """
        contest = self._contests.get((level, behaviour))
        nearest = None if contest is None else contest.index.nearest(situation * contest.weights)
        if contest is None or nearest is None:
            return None
        rla = self._rlas[contest.ids[nearest.position]]
        if rla.asks and not asking:
            return self._match_passing_over(contest, situation)
        runner_up = self._rlas[contest.ids[nearest.runner_up]] if nearest.runner_up >= 0 else None
        radius = contest.radius if rla.radius is None else rla.radius
        if math.isnan(nearest.distance):  # of a robot that does not know where it is: far from all, not near nothing
            return Match(rla, math.inf, radius, runner_up, math.inf)
        return Match(rla, nearest.distance, radius, runner_up, nearest.runner_up_distance)

    def nearest_first(
        self, situation: NDArray[np.float64], behaviour: str = "", level: str = BASIC, *, most: int | None = None
    ) -> tuple[tuple[int, float], ...]:
        """Ids and distances of the RLAs of a level and behaviour, the nearest to a situation (d,) first.

        `most`: so many of them; None: all. Looks at all of them: to explain with, not for every tick.
        """
        contest = self._contests.get((level, behaviour))
        if contest is None or not contest.ids:
            return ()
        distances = contest.index.distances(situation * contest.weights)
        if most is None or most >= len(distances):
            order = np.argsort(distances, kind="stable").tolist()  # of equally near ones the older
        else:
            # Only those as near as the last one that is wanted are put in order; NaN, far off, comes behind all.
            limit = np.partition(distances, most - 1)[most - 1]
            near = np.flatnonzero((distances <= limit) | np.isnan(limit))
            order = near[np.argsort(distances[near], kind="stable")][:most].tolist()
        return tuple(
            (contest.ids[place], math.inf if math.isnan(distances[place]) else float(distances[place]))
            for place in order
        )

    def competing(self, behaviour: str = "", level: str = BASIC) -> int:
        """How many RLAs of a level and behaviour compete."""
        contest = self._contests.get((level, behaviour))
        return 0 if contest is None else len(contest.ids)

    def _match_passing_over(self, contest: Contest, situation: NDArray[np.float64]) -> Match | None:
        """The nearest that has an action: looks at all, for it is seldom needed."""
        distances = contest.index.distances(situation * contest.weights)
        order = np.argsort(distances, kind="stable").tolist()  # of equally near ones the older
        found = [place for place in order if not self._rlas[contest.ids[place]].asks][:2]
        if not found:
            return None
        rla = self._rlas[contest.ids[found[0]]]
        radius = contest.radius if rla.radius is None else rla.radius
        if len(found) == 1:
            return Match(rla, float(distances[found[0]]), radius, None, math.inf)
        runner_up = self._rlas[contest.ids[found[1]]]
        return Match(rla, float(distances[found[0]]), radius, runner_up, float(distances[found[1]]))

    def competitors(self, rla: Rla) -> tuple[Rla, ...]:
        """The living RLAs of its level and behaviour with exactly its condition, itself among them, oldest first."""
        return self._groups.of(rla)

    def neighbours(self, rla: Rla, count: int) -> tuple[Rla, ...]:
        """The RLAs of its level and behaviour with another condition, nearest first, at most `count`.

        Sorts all of them: not for every tick.
        """
        contest = self._contests.get((rla.level, rla.behaviour))
        if contest is None:
            return ()
        others = (self._rlas[rla_id] for rla_id in contest.nearest_first(rla.condition))
        return tuple(islice((other for other in others if other.condition != rla.condition), count))

    def apply(self, event: TeachingEvent) -> None:
        """Change the knowledge as the event says. Raises UnfitEventError, and changes nothing, when it does not fit."""
        match event:
            case LessonUndone(lesson, _):
                problem = self._book.why_not_undo(lesson)
                if problem is not None:
                    raise UnfitEventError(problem)
                self._take_back(self._book.strike(lesson))
            case LessonRedone(lesson, _):
                problem = self._book.why_not_redo(lesson)
                if problem is not None:
                    raise UnfitEventError(problem)
                self._learn(self._book.put_back(lesson), again=True)
            case SessionBegun() | Appraised() | KnowledgeMerged():
                pass
            case SessionEnded(lasted_ticks, _):
                self.teaching_ticks += lasted_ticks
            case _:
                command_id = event.origin.command_id
                if self._book.get(command_id) is not None:
                    raise UnfitEventError(f"command {command_id!r} has taught a lesson already")
                self._learn(event)
                self._book.enter(event)
        self.changes += 1

    def apply_all(self, events: Iterable[TeachingEvent]) -> None:
        """Apply events in order."""
        for event in events:
            self.apply(event)

    def knowledge_hash(self) -> str:
        """Fingerprint of what the system knows: ids, levels, behaviours, conditions, actions, radii; not who taught."""
        return knowledge_hash_of(self._all_rlas())

    def _learn(self, lesson: Lesson, *, again: bool = False) -> None:
        """`again`: it was taken back, and its RLA or name is as it found it."""
        match lesson:
            case RlaCreated(rla):
                if rla.rla_id <= self._last_id and not again:
                    raise UnfitEventError(f"RLA {rla.rla_id} cannot be created: ids up to {self._last_id} are taken")
                _require_an_action(rla.action)
                try:
                    self._enter(rla)
                except ValueError as error:
                    raise UnfitEventError(f"RLA {rla.rla_id}: {error}") from error
                self._last_id = max(self._last_id, rla.rla_id)
            case ActionReplaced(rla_id, action, _, origin):
                _require_an_action(action)
                self._change(self._living(rla_id), action, origin)
            case ActionWithdrawn(rla_id, _, origin):
                rla = self._living(rla_id)
                if rla.asks:
                    raise UnfitEventError(f"{rla.title} asks already; its action cannot be withdrawn twice")
                self._change(rla, ASK, origin)
            case RlaDeleted(rla_id, origin):
                self._before[origin.command_id] = self._leave(self._living(rla_id))
            case SituationNamed(name, situation, level):
                self._require_situation(name, situation, level)
                self._names.enter(lesson)
            case RlaRewarded(rla_id, value):
                self._living(rla_id)
                if value not in (1, -1):
                    raise UnfitEventError(f"a reward of {value} for RLA {rla_id}: it must be 1 or -1")
                self._count(rla_id, value, 1)

    def _take_back(self, lesson: Lesson) -> None:
        """Undo a lesson after which nothing that stands happened to its RLA."""
        match lesson:
            case RlaCreated(rla):
                self._leave(self._living(rla.rla_id))
            case ActionReplaced(rla_id, origin=origin) | ActionWithdrawn(rla_id, origin=origin):
                self._living(rla_id)
                self._put(self._before.pop(origin.command_id))
            case RlaDeleted(_, origin):
                self._enter(self._before.pop(origin.command_id))
            case RlaRewarded(rla_id, value):
                self._count(rla_id, value, -1)
            case SituationNamed():
                self._names.leave(lesson)

    def _require_situation(self, name: str, situation: Condition, level: str) -> None:
        """A situation of a level that nothing is matched at here may be named all the same, as its RLAs are kept."""
        space = self._spaces.get(level)
        if not all(map(math.isfinite, situation)):
            raise UnfitEventError(f"the situation named {name!r} holds a value that is not finite")
        if space is not None and len(situation) != space.dimensions:
            raise UnfitEventError(
                f"the situation named {name!r} has {len(situation)} values, level {level} matches {space.dimensions}"
            )

    def _count(self, rla_id: int, value: int, more: int) -> None:
        rewards, punishments = self.appraisal(rla_id)
        self._appraisals[rla_id] = (
            Appraisal(rewards + more, punishments) if value > 0 else Appraisal(rewards, punishments + more)
        )

    def _change(self, old: Rla, action: str, origin: Origin) -> None:
        self._put(replace(old, action=action, origin=origin))
        self._before[origin.command_id] = old

    def _put(self, rla: Rla) -> None:
        """In the place of one that lives, with the same condition."""
        self._rlas[rla.rla_id] = rla
        self._groups.put(rla)

    def _enter(self, rla: Rla) -> None:
        space = self._spaces.get(rla.level)
        if space is not None:
            contest = self._contests.get((rla.level, rla.behaviour)) or Contest(space)
            contest.enter(rla.rla_id, rla.condition)
            self._contests[rla.level, rla.behaviour] = contest
        self._put(rla)
        self._count_at[rla.level] += 1

    def _leave(self, rla: Rla) -> Rla:
        if rla.level in self._spaces:
            self._contests[rla.level, rla.behaviour].leave(rla.rla_id)
        self._groups.leave(rla)
        self._count_at[rla.level] -= 1
        return self._rlas.pop(rla.rla_id)

    def _all_rlas(self) -> tuple[Rla, ...]:
        return tuple(self._rlas[rla_id] for rla_id in sorted(self._rlas))

    def _living(self, rla_id: int) -> Rla:
        rla = self._rlas.get(rla_id)
        if rla is None:
            raise UnfitEventError(f"there is no RLA {rla_id}; living ones: 1 to {self._last_id}, fewer the deleted")
        return rla


def _require_an_action(action: str) -> None:
    if action == ASK:
        raise UnfitEventError(f"{ASK!r} is no action that can be taught; withdraw the RLA's action instead")
