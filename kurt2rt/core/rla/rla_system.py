"""RLA system: the fold of teaching events; the RLA nearest to a situation answers it (paper, section III).

RLAs of each level and taught behaviour compete among themselves; ids and the history of lessons are common to all.
"""

import hashlib
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.outcome import Outcome
from kurt2rt.core.rla.active_rlas import ActiveRlas, Match
from kurt2rt.core.rla.condition import Condition, Space
from kurt2rt.core.rla.event_error import EventFault, InvalidEventError
from kurt2rt.core.rla.events import (
    ActionReplaced,
    ActionWithdrawn,
    Appraised,
    Lesson,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    SessionBegun,
    SessionEnded,
    SituationNamed,
    TeachingEvent,
)
from kurt2rt.core.rla.lesson_history import LessonHistory, LessonRecord
from kurt2rt.core.rla.rla import ASK, BASIC, Origin, Rla
from kurt2rt.core.rla.statistics import Appraisal, RewardCounts


class NamedSituations:
    """Situations by level and name; the newest one of a name counts until its lesson is undone."""

    def __init__(self) -> None:
        self._stacks: dict[tuple[str, str], list[Condition]] = {}

    def add(self, named: SituationNamed) -> None:
        """Give a name to a situation of a level, in addition to earlier situations of this name."""
        self._stacks.setdefault((named.level, named.name), []).append(named.situation)

    def remove(self, named: SituationNamed) -> None:
        """Undo the newest lesson of a name; the situation of the lesson before counts again. Raises KeyError."""
        stack = self._stacks[named.level, named.name]
        stack.pop()
        if not stack:
            del self._stacks[named.level, named.name]

    def for_level(self, level: str) -> Mapping[str, Condition]:
        """Return the newest situation of each name of a level, by name."""
        return {name: stack[-1] for (of_level, name), stack in self._stacks.items() if of_level == level}


def knowledge_hash_of(rlas: Iterable[Rla]) -> str:
    """Return the SHA-256 of RLAs, given in the order of their ids; teachers and dates do not count."""
    digest = hashlib.sha256()
    for rla in rlas:
        at = f"at {rla.level} " if rla.level != BASIC else ""
        of = f"of {rla.behaviour} " if rla.behaviour else ""
        digest.update(f"{rla.rla_id} {at}{of}{rla.action} {rla.radius!r} ".encode())
        digest.update(np.array(rla.condition, dtype=np.float64).tobytes())
    return digest.hexdigest()


class RlaSystem:
    """Knowledge of a robot: the RLAs that lessons made, and the search for the nearest one (paper, section III).

    `apply` folds one teaching event, so the same events in the same order give the same system, hash included.
    `match` finds the RLA of least distance ||w (c - s)||, with feature weights w, condition c and situation s. Of
    equal distances the older RLA wins. The tick calls `match` at each decision; only the tick applies events.
    """

    def __init__(
        self,
        dimensions: int,
        radius: float,
        weights: NDArray[np.float64] | None = None,
        *,
        others: Mapping[str, Space] | None = None,
    ) -> None:
        """Create an empty system.

        Args:
            dimensions: length d of a basic-level situation.
            radius: confidence radius of RLAs without an own one.
            weights: weight of each feature in a distance, shape (d,); None: all 1.
            others: spaces of further levels. RLAs of other levels are kept and can be undone, but are never matched:
                a robot without a critic can use knowledge that has one.
        """
        self.dimensions = dimensions
        self.radius = radius
        self.weights = np.ones(dimensions) if weights is None else weights
        self.teaching_ticks = 0
        """Total duration of the ended sessions, in ticks."""
        self.changes = 0
        """Number of applied events; while it is unchanged, equal situations have equal matches."""
        self.is_guess: Callable[[Rla], bool] | None = None
        """Predicate of guesses, which a robot without a teacher passes over at the basic level; None: none is one."""
        self._spaces = {**(others or {}), BASIC: Space(dimensions, radius, self.weights)}
        self._active = ActiveRlas(self._spaces)
        self._last_id = 0
        self._rewards = RewardCounts()
        self._names = NamedSituations()
        self._history = LessonHistory()
        self._before: dict[str, str] = {}
        """Command id of each standing lesson that changed an action -> id of the lesson that gave the action before."""
        self._deleted: dict[str, Rla] = {}
        """Deleted RLAs, by command id of the deletion."""

    def __len__(self) -> int:
        return self._active.count(BASIC)

    @property
    def rlas(self) -> tuple[Rla, ...]:
        """All active RLAs of the basic level, of all behaviours, oldest first."""
        return self.rlas_at(BASIC)

    def rlas_at(self, level: str) -> tuple[Rla, ...]:
        """Return all active RLAs of a level, of all behaviours, oldest first."""
        return tuple(rla for rla in self._active if rla.level == level)

    @property
    def active_rlas(self) -> tuple[Rla, ...]:
        """All active RLAs of all levels, in no order: a copy that is cheap enough for each tick."""
        return self._active.unsorted

    @property
    def next_id(self) -> int:
        """Id of the next RLA to be taught; ids of deleted or undone RLAs are not used again."""
        return self._last_id + 1

    def get(self, rla_id: int) -> Rla | None:
        """Return the active RLA of an id, of any level; None if there is none."""
        return self._active.get(rla_id)

    def named_situations(self, level: str) -> Mapping[str, Condition]:
        """Return the named situations of a level, by name."""
        return self._names.for_level(level)

    def appraisal(self, rla_id: int) -> Appraisal:
        """Return the numbers of rewards and punishments of an RLA; zeros for an unknown id."""
        return self._rewards.get(rla_id)

    @property
    def lessons(self) -> tuple[LessonRecord, ...]:
        """All lessons, oldest first, undone ones included."""
        return self._history.records

    def lessons_about(self, rla_id: int) -> tuple[LessonRecord, ...]:
        """Return all lessons about one RLA, oldest first, undone ones included."""
        return self._history.about(rla_id)

    @property
    def standing_lessons(self) -> int:
        """Number of standing lessons, rewards included."""
        return self._history.standing

    @property
    def last_standing_lesson(self) -> str | None:
        """Command id of the newest lesson that is not undone; None without one."""
        return self._history.last_standing

    def lesson(self, command_id: str) -> LessonRecord | None:
        """Return the lesson of a command; None for an unknown id."""
        return self._history.get(command_id)

    def why_not_undo(self, command_id: str) -> Outcome | None:
        """Return why the lesson of a command cannot be undone now; None if it can."""
        return self._history.why_not_undo(command_id)

    def lessons_of_hold(self, hold: str) -> tuple[str, ...]:
        """Return the command ids of all lessons of a hold, oldest first, undone ones included; empty if it has none."""
        return self._history.of_hold(hold)

    def unused_hold_id(self, hold: str) -> str:
        """Return `hold`, or `hold` with the first free number if an earlier run's hold of this id gave lessons."""
        unused, number = hold, 1
        while self._history.of_hold(unused):
            number += 1
            unused = f"{hold}-{number}"
        return unused

    def why_not_undo_hold(self, hold: str) -> Outcome | None:
        """Return why the standing lessons of a hold cannot be undone together now; None if they can."""
        return self._history.why_not_undo_hold(hold)

    @property
    def last_undone_lesson(self) -> str | None:
        """Command id of the lesson that was undone last; None if none is undone."""
        return self._history.last_undone

    def why_not_redo(self, command_id: str) -> Outcome | None:
        """Return why the lesson of a command cannot be redone now; None if it can."""
        return self._history.why_not_redo(command_id)

    def restored_by_undo(self, command_id: str) -> Rla | None:
        """Return the RLA as an undo of a lesson would restore it; None if that undo restores no action."""
        before = self._before.get(command_id)
        return self._deleted.get(command_id) if before is None else self._as_taught_by(before)

    def match(
        self, situation: NDArray[np.float64], behaviour: str = "", level: str = BASIC, *, include_withdrawn: bool = True
    ) -> Match | None:
        """Return the RLA of a level and taught behaviour nearest to a situation (d,), and the runner-up.

        Returns None if nothing was taught yet. Distances are infinite if the situation holds NaN.
        `include_withdrawn`: False passes over RLAs without an action, and guesses, for a robot without a teacher.
        """
        return self._active.match(situation, behaviour, level, None if include_withdrawn else self.passes_over)

    def passes_over(self, rla: Rla) -> bool:
        """Return whether a robot without a teacher lets neighbours of an RLA answer: of a withdrawn one and a guess."""
        return rla.is_withdrawn or (rla.level == BASIC and self.is_guess is not None and self.is_guess(rla))

    @property
    def radius_share(self) -> float:
        """Fraction of R, 0 to 1, within which RLAs of the basic level answer now; 1 unless a robot asks sooner."""
        return self._active.radius_share

    @radius_share.setter
    def radius_share(self, share: float) -> None:
        self._active.radius_share = share

    def radius_of(self, rla: Rla) -> float:
        """Return the distance in counts, or m for a place, up to which an RLA of a matched level answers now."""
        return self._active.radius_of(rla)

    def whole_radius(self, rla: Rla) -> float:
        """Return R of an RLA of a matched level in counts, or m for a place, also while it asks sooner."""
        return self._active.whole_radius(rla)

    def nearest_first(
        self, situation: NDArray[np.float64], behaviour: str = "", level: str = BASIC, *, limit: int | None = None
    ) -> tuple[tuple[int, float], ...]:
        """Return (id, distance) of the RLAs of a level and behaviour, nearest to a situation (d,) first.

        Computes all distances: for explanations, not for each tick. `limit`: largest number of RLAs; None: all.
        """
        return self._active.nearest_first(situation, behaviour, level, limit)

    def candidate_count(self, behaviour: str = "", level: str = BASIC) -> int:
        """Return the number of RLAs that compete at a level for a behaviour."""
        return self._active.candidate_count(behaviour, level)

    def competitors(self, rla: Rla) -> tuple[Rla, ...]:
        """Return the RLAs of its level and behaviour with an equal condition, itself included, oldest first."""
        return self._active.competitors(rla)

    def neighbours(self, rla: Rla, count: int) -> tuple[Rla, ...]:
        """Return at most `count` RLAs of its level and behaviour with another condition, nearest first; sorts all."""
        return self._active.neighbours(rla, count)

    def apply(self, event: TeachingEvent) -> None:
        """Change the knowledge by an event. Raises InvalidEventError, changing nothing, if the event does not fit."""
        match event:
            case LessonUndone(lesson, _):
                problem = self._history.why_not_undo(lesson)
                if problem is not None:
                    raise InvalidEventError(EventFault.NOT_UNDOABLE, {"lesson": lesson}, problem)
                self._undo(self._history.undo(lesson))
            case LessonRedone(lesson, _):
                problem = self._history.why_not_redo(lesson)
                if problem is not None:
                    raise InvalidEventError(EventFault.NOT_REDOABLE, {"lesson": lesson}, problem)
                self._learn(self._history.redo(lesson), again=True)
            case SessionBegun() | Appraised():
                pass
            case SessionEnded(lasted_ticks, _):
                self.teaching_ticks += lasted_ticks
            case _:
                command_id = event.origin.command_id
                if self._history.get(command_id) is not None:
                    raise InvalidEventError.of(EventFault.LESSON_EXISTS, command_id=command_id)
                self._learn(event)
                self._history.add(event)
        self.changes += 1

    def apply_all(self, events: Iterable[TeachingEvent]) -> None:
        """Apply events in order. Raises InvalidEventError at the first that does not fit; those before it stay."""
        for event in events:
            self.apply(event)

    def knowledge_hash(self) -> str:
        """Return the SHA-256 of all active RLAs; teachers and dates do not count."""
        return knowledge_hash_of(self._active)

    def _learn(self, lesson: Lesson, *, again: bool = False) -> None:
        """Apply a lesson; `again`: as a redo."""
        match lesson:
            case RlaCreated(rla):
                if rla.rla_id <= self._last_id and not again:
                    raise InvalidEventError.of(EventFault.RLA_EXISTS, rla_id=rla.rla_id, last=self._last_id)
                _require_action(rla.action)
                try:
                    self._active.add(rla)
                except ValueError as error:
                    raise InvalidEventError.of(EventFault.BAD_CONDITION, rla_id=rla.rla_id, error=str(error)) from error
                self._last_id = max(self._last_id, rla.rla_id)
            case ActionReplaced(rla_id, action, _, origin):
                _require_action(action)
                self._change(self._require_active(rla_id), action, origin)
            case ActionWithdrawn(rla_id, _, origin):
                rla = self._require_active(rla_id)
                if rla.is_withdrawn:
                    raise InvalidEventError.of(EventFault.WITHDRAWN_ALREADY, title=rla.title)
                self._change(rla, ASK, origin)
            case RlaDeleted(rla_id, origin):
                self._deleted[origin.command_id] = self._active.remove(self._require_active(rla_id))
            case SituationNamed(name, situation, level):
                self._require_situation(name, situation, level)
                self._names.add(lesson)
            case RlaRewarded(rla_id, value):
                self._require_active(rla_id)
                if value not in (1, -1):
                    raise InvalidEventError.of(EventFault.BAD_REWARD, rla_id=rla_id, value=value)
                self._rewards.add(rla_id, value)

    def _undo(self, lesson: Lesson) -> None:
        """Reverse a lesson that is on top of its stack."""
        match lesson:
            case RlaCreated(rla):
                self._active.remove(self._require_active(rla.rla_id))
            case ActionReplaced(rla_id, origin=origin) | ActionWithdrawn(rla_id, origin=origin):
                self._require_active(rla_id)
                self._active.replace(self._as_taught_by(self._before.pop(origin.command_id)))
            case RlaDeleted(_, origin):
                self._active.add(self._deleted.pop(origin.command_id))
            case RlaRewarded(rla_id, value):
                self._rewards.remove(rla_id, value)
            case SituationNamed():
                self._names.remove(lesson)

    def _require_situation(self, name: str, situation: Condition, level: str) -> None:
        """Raise InvalidEventError for a wrong length or a number that is not finite; levels without a space fit."""
        space = self._spaces.get(level)
        if not all(map(math.isfinite, situation)):
            raise InvalidEventError.of(EventFault.NOT_FINITE, name=name)
        if space is not None and len(situation) != space.dimensions:
            raise InvalidEventError.of(
                EventFault.BAD_SITUATION, name=name, got=len(situation), level=level, expected=space.dimensions
            )

    def _change(self, old: Rla, action: str, origin: Origin) -> None:
        self._active.replace(replace(old, action=action, origin=origin))
        self._before[origin.command_id] = old.origin.command_id

    def _as_taught_by(self, command_id: str) -> Rla:
        """Return the RLA as a lesson left it that gave or withdrew its action."""
        record = self._history.get(command_id)
        assert record is not None
        match record.event:
            case RlaCreated(rla):
                return rla
            case ActionReplaced(rla_id, action, _, origin):
                return replace(self._as_created(rla_id), action=action, origin=origin)
            case ActionWithdrawn(rla_id, _, origin):
                return replace(self._as_created(rla_id), action=ASK, origin=origin)
        raise AssertionError(f"{command_id!r} gave no action")

    def _as_created(self, rla_id: int) -> Rla:
        first = self._history.first_about(rla_id).event
        assert isinstance(first, RlaCreated)
        return first.rla

    def _require_active(self, rla_id: int) -> Rla:
        rla = self._active.get(rla_id)
        if rla is None:
            raise InvalidEventError.of(EventFault.NO_RLA, rla_id=rla_id, last=self._last_id)
        return rla


def _require_action(action: str) -> None:
    if action == ASK:
        raise InvalidEventError.of(EventFault.BAD_ACTION, action=ASK)
