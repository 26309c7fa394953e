"""RLA system: the fold of teaching events; the RLA nearest to a situation answers it (paper, section III).

RLAs of each level and taught behaviour compete among themselves; ids and the history of lessons are common to all.
"""

import hashlib
import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.rla.active_rlas import ActiveRlas
from kurt2rt.core.rla.condition import Condition, Space
from kurt2rt.core.rla.events import (
    ActionReplaced,
    ActionWithdrawn,
    Appraised,
    EventFault,
    InvalidEventError,
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
from kurt2rt.core.rla.image import Image
from kurt2rt.core.rla.lesson_history import LessonHistory
from kurt2rt.core.rla.rla import ASK, BASIC, Origin, Rla
from kurt2rt.core.rla.statistics import Appraisal


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


class RlaSystem(ActiveRlas):
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
        images: Sequence[Image] = (),
    ) -> None:
        """Create an empty system.

        Args:
            dimensions: length d of a basic-level situation.
            radius: confidence radius of RLAs without an own one.
            weights: weight of each feature in a distance, shape (d,); None: all 1.
            others: spaces of further levels. RLAs of other levels are kept and can be undone, but are never matched:
                a robot without a critic can use knowledge that has one.
            images: in which each RLA of the basic level answers, too.
        """
        self.dimensions = dimensions
        self.radius = radius
        self.weights = np.ones(dimensions) if weights is None else weights
        self.teaching_ticks = 0
        """Total duration of the ended sessions, in ticks."""
        self.changes = 0
        """Number of applied events; while it is unchanged, equal situations have equal matches."""
        super().__init__({**(others or {}), BASIC: Space(dimensions, radius, self.weights)}, images)
        self._last_id = 0
        self._rewards = Counter[tuple[int, bool]]()
        """Number of standing rewards by RLA id, and whether they are +1."""
        self._names = NamedSituations()
        self.history = LessonHistory()
        """All lessons, and which of them can be undone and redone."""
        self._before: dict[str, str] = {}
        """Command id of each standing lesson that changed an action -> id of the lesson that gave the action before."""
        self._deleted: dict[str, Rla] = {}
        """Deleted RLAs, by command id of the deletion."""

    @property
    def next_id(self) -> int:
        """Id of the next RLA to be taught; ids of deleted or undone RLAs are not used again."""
        return self._last_id + 1

    def named_situations(self, level: str) -> Mapping[str, Condition]:
        """Return the named situations of a level, by name."""
        return self._names.for_level(level)

    def appraisal(self, rla_id: int) -> Appraisal:
        """Return the numbers of rewards and punishments of an RLA; zeros for an unknown id."""
        return Appraisal(self._rewards[rla_id, True], self._rewards[rla_id, False])

    def restored_by_undo(self, command_id: str) -> Rla | None:
        """Return the RLA as an undo of a lesson would restore it; None if that undo restores no action."""
        before = self._before.get(command_id)
        return self._deleted.get(command_id) if before is None else self._as_taught_by(before)

    def apply(self, event: TeachingEvent) -> None:
        """Change the knowledge by an event. Raises InvalidEventError, changing nothing, if the event does not fit."""
        match event:
            case LessonUndone(lesson, _):
                problem = self.history.why_not_undo(lesson)
                if problem is not None:
                    raise InvalidEventError(EventFault.NOT_UNDOABLE, {"lesson": lesson}, problem)
                self._undo(self.history.undo(lesson))
            case LessonRedone(lesson, _):
                problem = self.history.why_not_redo(lesson)
                if problem is not None:
                    raise InvalidEventError(EventFault.NOT_REDOABLE, {"lesson": lesson}, problem)
                self._learn(self.history.redo(lesson), again=True)
            case SessionBegun() | Appraised():
                pass
            case SessionEnded(lasted_ticks, _):
                self.teaching_ticks += lasted_ticks
            case _:
                command_id = event.origin.command_id
                if self.history.get(command_id) is not None:
                    raise InvalidEventError.of(EventFault.LESSON_EXISTS, command_id=command_id)
                self._learn(event)
                self.history.add(event)
        self.changes += 1

    def apply_all(self, events: Iterable[TeachingEvent]) -> None:
        """Apply events in order. Raises InvalidEventError at the first that does not fit; those before it stay."""
        for event in events:
            self.apply(event)

    def knowledge_hash(self) -> str:
        """Return the SHA-256 of all active RLAs; teachers and dates do not count."""
        return knowledge_hash_of(self._oldest_first())

    def _learn(self, lesson: Lesson, *, again: bool = False) -> None:
        """Apply a lesson; `again`: as a redo."""
        match lesson:
            case RlaCreated(rla):
                if rla.rla_id <= self._last_id and not again:
                    raise InvalidEventError.of(EventFault.RLA_EXISTS, rla_id=rla.rla_id, last=self._last_id)
                _require_action(rla.action)
                try:
                    self._add(rla)
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
                self._deleted[origin.command_id] = self._remove(self._require_active(rla_id))
            case SituationNamed(name, situation, level):
                self._require_situation(name, situation, level)
                self._names.add(lesson)
            case RlaRewarded(rla_id, value):
                self._require_active(rla_id)
                if value not in (1, -1):
                    raise InvalidEventError.of(EventFault.BAD_REWARD, rla_id=rla_id, value=value)
                self._rewards[rla_id, value > 0] += 1

    def _undo(self, lesson: Lesson) -> None:
        """Reverse a lesson that is on top of its stack."""
        match lesson:
            case RlaCreated(rla):
                self._remove(self._require_active(rla.rla_id))
            case ActionReplaced(rla_id, origin=origin) | ActionWithdrawn(rla_id, origin=origin):
                self._require_active(rla_id)
                self._replace(self._as_taught_by(self._before.pop(origin.command_id)))
            case RlaDeleted(_, origin):
                self._add(self._deleted.pop(origin.command_id))
            case RlaRewarded(rla_id, value):
                self._rewards[rla_id, value > 0] -= 1
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
        self._replace(replace(old, action=action, origin=origin))
        self._before[origin.command_id] = old.origin.command_id

    def _as_taught_by(self, command_id: str) -> Rla:
        """Return the RLA as a lesson left it that gave or withdrew its action."""
        match self.history.event_of(command_id):
            case RlaCreated(rla):
                return rla
            case ActionReplaced(rla_id, action, _, origin):
                return replace(self._as_created(rla_id), action=action, origin=origin)
            case ActionWithdrawn(rla_id, _, origin):
                return replace(self._as_created(rla_id), action=ASK, origin=origin)
        raise AssertionError(f"{command_id!r} gave no action")

    def _as_created(self, rla_id: int) -> Rla:
        first = self.history.first_about(rla_id).event
        assert isinstance(first, RlaCreated)
        return first.rla

    def _require_active(self, rla_id: int) -> Rla:
        rla = self.get(rla_id)
        if rla is None:
            raise InvalidEventError.of(EventFault.NO_RLA, rla_id=rla_id, last=self._last_id)
        return rla


def _require_action(action: str) -> None:
    if action == ASK:
        raise InvalidEventError.of(EventFault.BAD_ACTION, action=ASK)
