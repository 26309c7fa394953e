"""RLA system: the fold of teaching events; the RLA nearest to a situation answers it (paper, section III).

RLAs of each level and taught behaviour compete among themselves; ids and the history of lessons are common to all.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.outcome import Outcome
from kurt2rt.core.rla.active_rlas import ActiveRlas
from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.events import (
    ActionReplaced,
    ActionWithdrawn,
    Appraised,
    KnowledgeMerged,
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
from kurt2rt.core.rla.fingerprint import knowledge_hash_of
from kurt2rt.core.rla.lesson_history import LessonHistory, LessonRecord
from kurt2rt.core.rla.match import Match
from kurt2rt.core.rla.named_situations import NamedSituations
from kurt2rt.core.rla.reward_counts import Appraisal, RewardCounts
from kurt2rt.core.rla.rla import ASK, BASIC, Origin, Rla
from kurt2rt.core.rla.space import Space


class EventFault(StrEnum):
    """Code for why a teaching event does not fit the knowledge."""

    NOT_UNDOABLE = "not undoable"
    NOT_REDOABLE = "not redoable"
    LESSON_EXISTS = "lesson exists"
    """Another lesson has its command id."""
    RLA_EXISTS = "rla exists"
    NO_RLA = "no rla"
    BAD_CONDITION = "bad condition"
    BAD_SITUATION = "bad situation"
    BAD_ACTION = "bad action"
    BAD_REWARD = "bad reward"
    WITHDRAWN_ALREADY = "withdrawn already"
    NO_LEVEL = "no level"
    """The knowledge file does not name the features of its level."""


class InvalidEventError(ValueError):
    """Teaching event that does not fit the knowledge it should change."""

    def __init__(self, fault: EventFault, what: str, refusal: Outcome | None = None) -> None:
        """`refusal`: why a lesson cannot be undone or redone; None for other faults."""
        super().__init__(what)
        self.fault = fault
        self.refusal = refusal


class RlaSystem:
    """Fold of teaching events: active RLAs, named situations, numbers of rewards and the history of lessons."""

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
        """Return the active RLA of an id, of any level."""
        return self._active.get(rla_id)

    def named_situations(self, level: str) -> Mapping[str, Condition]:
        """Return the named situations of a level, by name."""
        return self._names.for_level(level)

    def appraisal(self, rla_id: int) -> Appraisal:
        """Return the numbers of rewards and punishments of an RLA."""
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
        """Command id of the newest standing lesson."""
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
        """Return the id of a hold, with a number if an earlier run's hold of this id gave lessons."""
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
        """Command id of the lesson that was undone last."""
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
        `include_withdrawn`: False skips RLAs without an action, for a robot without a teacher.
        """
        return self._active.match(situation, behaviour, level, include_withdrawn=include_withdrawn)

    def nearest_first(
        self, situation: NDArray[np.float64], behaviour: str = "", level: str = BASIC, *, limit: int | None = None
    ) -> tuple[tuple[int, float], ...]:
        """Return (id, distance) of the RLAs of a level and behaviour, nearest to a situation (d,) first.

        Computes all distances: for explanations, not for each tick. `limit`: None returns all RLAs.
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
                    raise _not_possible(EventFault.NOT_UNDOABLE, lesson, problem)
                self._undo(self._history.undo(lesson))
            case LessonRedone(lesson, _):
                problem = self._history.why_not_redo(lesson)
                if problem is not None:
                    raise _not_possible(EventFault.NOT_REDOABLE, lesson, problem)
                self._learn(self._history.redo(lesson), again=True)
            case SessionBegun() | Appraised() | KnowledgeMerged():
                pass
            case SessionEnded(lasted_ticks, _):
                self.teaching_ticks += lasted_ticks
            case _:
                command_id = event.origin.command_id
                if self._history.get(command_id) is not None:
                    raise InvalidEventError(
                        EventFault.LESSON_EXISTS, f"command {command_id!r} has taught a lesson already"
                    )
                self._learn(event)
                self._history.add(event)
        self.changes += 1

    def apply_all(self, events: Iterable[TeachingEvent]) -> None:
        """Apply events in order."""
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
                    raise InvalidEventError(
                        EventFault.RLA_EXISTS,
                        f"RLA {rla.rla_id} cannot be created: ids up to {self._last_id} are taken",
                    )
                _require_action(rla.action)
                try:
                    self._active.add(rla)
                except ValueError as error:
                    raise InvalidEventError(EventFault.BAD_CONDITION, f"RLA {rla.rla_id}: {error}") from error
                self._last_id = max(self._last_id, rla.rla_id)
            case ActionReplaced(rla_id, action, _, origin):
                _require_action(action)
                self._change(self._require_active(rla_id), action, origin)
            case ActionWithdrawn(rla_id, _, origin):
                rla = self._require_active(rla_id)
                if rla.is_withdrawn:
                    raise InvalidEventError(
                        EventFault.WITHDRAWN_ALREADY, f"{rla.title} has no action; withdraw an action once"
                    )
                self._change(rla, ASK, origin)
            case RlaDeleted(rla_id, origin):
                self._deleted[origin.command_id] = self._active.remove(self._require_active(rla_id))
            case SituationNamed(name, situation, level):
                self._require_situation(name, situation, level)
                self._names.add(lesson)
            case RlaRewarded(rla_id, value):
                self._require_active(rla_id)
                if value not in (1, -1):
                    raise InvalidEventError(
                        EventFault.BAD_REWARD, f"RLA {rla_id}: wrong reward (got {value}, allowed -1, 1)"
                    )
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
            raise InvalidEventError(
                EventFault.BAD_SITUATION, f"the situation named {name!r} holds a value that is not finite"
            )
        if space is not None and len(situation) != space.dimensions:
            raise InvalidEventError(
                EventFault.BAD_SITUATION,
                f"the situation named {name!r} has {len(situation)} values, level {level} matches {space.dimensions}",
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
            raise InvalidEventError(
                EventFault.NO_RLA,
                f"RLA {rla_id} does not exist (ids 1 to {self._last_id} were used; some are deleted)",
            )
        return rla


def _not_possible(fault: EventFault, lesson: str, refusal: Outcome) -> InvalidEventError:
    details = "".join(f", {key} {value}" for key, value in refusal.fields.items() if key != "lesson")
    return InvalidEventError(fault, f"lesson {lesson!r} is {fault}: {refusal.code}{details}", refusal)


def _require_action(action: str) -> None:
    if action == ASK:
        raise InvalidEventError(
            EventFault.BAD_ACTION, f"{ASK!r} is no action that can be taught; withdraw the RLA's action instead"
        )
