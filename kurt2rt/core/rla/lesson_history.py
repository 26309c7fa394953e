"""History of lessons, and the order in which they can be undone and redone."""

import re
from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import dataclass, replace

from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.rla.events import (
    ActionReplaced,
    ActionWithdrawn,
    Lesson,
    RlaCreated,
    RlaDeleted,
    RlaLesson,
    RlaRewarded,
    SituationNamed,
)
from kurt2rt.core.rla.rla import ASK, BASIC, rla_title

DERIVED = "/"
"""Separator in ids that the robot derives from a command's id; refused in the ids of teachers."""

_HOLD_LESSON = re.compile(rf"(.+-hold-\d+(?:-\d+)?){DERIVED}\d+", re.DOTALL)

LessonStack = int | tuple[str, str]
"""Key of a stack of lessons: an RLA id, or a level and the name of a situation."""


@dataclass(frozen=True, slots=True)
class LessonRecord:
    """Lesson of the history, with the flag that says if it was undone."""

    event: Lesson
    undone: bool = False
    behaviour: str = ""
    """Taught behaviour of its RLA; empty if the task has only one, or the lesson is a name."""
    level: str = BASIC
    """Level of its RLA or name."""

    @property
    def text(self) -> str:
        """Short description of the lesson for a teacher."""
        if isinstance(self.event, SituationNamed):
            return f"situation named: {self.event.name}"
        rla = rla_title(rla_id_of(self.event), self.behaviour, self.level)
        match self.event:
            case RlaCreated(taught):
                return f"{rla} taught: {taught.action}"
            case ActionReplaced(_, action, instead_of, _):
                if instead_of == ASK:
                    return f"{rla} answered again: {action}"
                return f"{rla} corrected: {action} instead of {instead_of}"
            case ActionWithdrawn():
                return f"{rla} withdrawn: it asks again"
            case RlaDeleted():
                return f"{rla} deleted"
            case RlaRewarded(value=value):
                return f"{rla} {'rewarded' if value > 0 else 'punished'}"


def hold_id(teacher: str, press_id: int) -> str:
    """Return the id of all lessons of a hold; the id of each lesson is this one, DERIVED and a tick."""
    return f"{teacher}-hold-{press_id}"


def hold_of(command_id: str) -> str | None:
    """Return the id of the hold that gave the lesson of a command; None if no hold gave it."""
    found = _HOLD_LESSON.fullmatch(command_id)
    return None if found is None else found[1]


def hold_text(records: Iterable[LessonRecord]) -> str:
    """Return a short description of the lessons of a hold, oldest first, for a teacher."""
    taught = [each.event for each in records]
    actions: dict[str, None] = {}
    for event in taught:
        if isinstance(event, RlaCreated):
            actions[event.rla.action] = None
        elif isinstance(event, ActionReplaced):
            actions[event.action] = None
    return f"held {', '.join(actions)}: {len(taught)} lesson{'' if len(taught) == 1 else 's'}"


def rla_id_of(lesson: RlaLesson) -> int:
    """Return the id of the RLA of a lesson."""
    return lesson.rla.rla_id if isinstance(lesson, RlaCreated) else lesson.rla_id


def lesson_stack(lesson: Lesson) -> LessonStack:
    """Return the key of a lesson's stack in a history: an RLA's id, or level and name of a situation."""
    return (lesson.level, lesson.name) if isinstance(lesson, SituationNamed) else rla_id_of(lesson)


class LessonHistory:
    """All lessons by command id, in stacks: of each stack only the newest standing lesson can be undone."""

    def __init__(self) -> None:
        self.standing = 0
        """Number of standing lessons."""
        self._records: list[LessonRecord] = []
        self._place: dict[str, int] = {}
        self._places_of: dict[LessonStack, list[int]] = {}
        """Index of each lesson of a stack, undone ones included."""
        self._standing_of: dict[LessonStack, list[int]] = {}
        self._kinds: dict[int, tuple[str, str]] = {}
        """Behaviour and level of each RLA ever created."""
        self._newest: list[int] = []
        """Indexes of all lessons up to the last standing one, ascending."""
        self._below: list[int | None] = []
        """Index of the lesson below each lesson in its stack."""
        self._undone: list[int] = []
        """Indexes of the undone lessons, in the order of their undos."""
        self._holds: dict[str, list[str]] = {}
        """Command ids of the lessons of each hold, undone ones included."""

    @property
    def records(self) -> tuple[LessonRecord, ...]:
        """All lessons, oldest first, undone ones included."""
        return tuple(self._records)

    @property
    def last_standing(self) -> str | None:
        """Command id of the newest lesson that is not undone; None without one."""
        return self._records[self._newest[-1]].event.origin.command_id if self._newest else None

    @property
    def last_undone(self) -> str | None:
        """Command id of the lesson that was undone last; None if none is undone."""
        return self._records[self._undone[-1]].event.origin.command_id if self._undone else None

    def get(self, command_id: str) -> LessonRecord | None:
        """Return the lesson of a command; None for an unknown id."""
        place = self._place.get(command_id)
        return None if place is None else self._records[place]

    def event_of(self, command_id: str) -> Lesson:
        """Return the lesson of a command, which must have given one, undone or not. Raises KeyError."""
        return self._records[self._place[command_id]].event

    def of_hold(self, hold: str) -> tuple[str, ...]:
        """Return the command ids of all lessons of a hold, oldest first, undone ones included; empty if it has none."""
        return tuple(self._holds.get(hold, ()))

    def standing_of_hold(self, hold: str) -> list[str]:
        """Return the command ids of the lessons of a hold that are not undone, oldest first."""
        return [each for each in self._holds.get(hold, ()) if not self._records[self._place[each]].undone]

    def unused_hold_id(self, hold: str) -> str:
        """Return `hold`, or `hold` with the first free number if an earlier run's hold of this id gave lessons."""
        unused, number = hold, 1
        while unused in self._holds:
            number += 1
            unused = f"{hold}-{number}"
        return unused

    def about(self, stack: LessonStack) -> tuple[LessonRecord, ...]:
        """Return all lessons of a stack, oldest first, undone ones included."""
        return tuple(self._records[place] for place in self._places_of.get(stack, ()))

    def first_about(self, stack: LessonStack) -> LessonRecord:
        """Return the oldest lesson of a stack. Raises KeyError for an empty stack."""
        return self._records[self._places_of[stack][0]]

    def add(self, lesson: Lesson) -> None:
        """Append a lesson, whose command id must be new."""
        place = len(self._records)
        self._place[lesson.origin.command_id] = place
        hold = hold_of(lesson.origin.command_id)
        if hold is not None:
            self._holds.setdefault(hold, []).append(lesson.origin.command_id)
        stack = self._standing_of.setdefault(lesson_stack(lesson), [])
        self._below.append(stack[-1] if stack else None)
        stack.append(place)
        self._places_of.setdefault(lesson_stack(lesson), []).append(place)
        self._newest.append(place)
        if isinstance(lesson, RlaCreated):
            self._kinds[lesson.rla.rla_id] = (lesson.rla.behaviour, lesson.rla.level)
        behaviour, level = ("", lesson.level) if isinstance(lesson, SituationNamed) else self._kinds[rla_id_of(lesson)]
        self._records.append(LessonRecord(lesson, behaviour=behaviour, level=level))
        self.standing += 1

    def why_not_undo(self, command_id: str) -> Outcome | None:
        """Return why the lesson of a command cannot be undone now; None if it can."""
        record = self.get(command_id)
        if record is None:
            return Outcome.of(RefusalCode.NO_SUCH_LESSON, lesson=command_id)
        if record.undone:
            return Outcome.of(RefusalCode.UNDONE_ALREADY, lesson=command_id)
        newest = self._records[self._standing_of[lesson_stack(record.event)][-1]]
        if newest is not record:
            later = newest.event.origin.command_id
            return Outcome.of(RefusalCode.TAUGHT_AFTER, later=later, lesson=command_id, says=newest.text)
        return None

    def why_not_undo_hold(self, hold: str) -> Outcome | None:
        """Return why the standing lessons of a hold cannot be undone together now; None if they can."""
        lessons = self.of_hold(hold)
        if not lessons:
            return Outcome.of(RefusalCode.NO_SUCH_LESSON, lesson=hold)
        standing = self.standing_of_hold(hold)
        if not standing:
            return Outcome.of(RefusalCode.UNDONE_ALREADY, lesson=hold)
        for command_id in standing:
            place = self._place[command_id]
            for above in reversed(self._standing_of[lesson_stack(self._records[place].event)]):
                if above == place:
                    break
                later = self._records[above]
                if hold_of(later.event.origin.command_id) != hold:
                    by = later.event.origin.command_id
                    return Outcome.of(RefusalCode.TAUGHT_AFTER, later=by, lesson=hold, says=later.text)
        return None

    def undo(self, command_id: str) -> Lesson:
        """Mark a lesson as undone and return it; call it only if `why_not_undo` returned None."""
        place = self._place[command_id]
        record = self._records[place]
        lesson = record.event
        stack = self._standing_of[lesson_stack(lesson)]
        stack.pop()
        if not stack:
            del self._standing_of[lesson_stack(lesson)]
        self._records[place] = replace(record, undone=True)
        self._undone.append(place)
        self.standing -= 1
        while self._newest and self._records[self._newest[-1]].undone:
            self._newest.pop()
        return lesson

    def why_not_redo(self, command_id: str) -> Outcome | None:
        """Return why the lesson of a command cannot be redone now; None if its stack is as the lesson found it."""
        record = self.get(command_id)
        if record is None:
            return Outcome.of(RefusalCode.NO_SUCH_LESSON, lesson=command_id)
        if not record.undone:
            return Outcome.of(RefusalCode.STANDS_ALREADY, lesson=command_id)
        below = self._below[self._place[command_id]]
        stack = self._standing_of.get(lesson_stack(record.event))
        top = stack[-1] if stack else None
        if top == below:
            return None
        if below is not None and self._records[below].undone:
            was = self._records[below]
            earlier = was.event.origin.command_id
            return Outcome.of(RefusalCode.STANDS_ON_UNDONE, lesson=command_id, earlier=earlier, says=was.text)
        assert top is not None  # the lesson below stands, so another lesson is on top of it
        newest = self._records[top]
        later = newest.event.origin.command_id
        return Outcome.of(RefusalCode.TAUGHT_INSTEAD, later=later, lesson=command_id, says=newest.text)

    def redo(self, command_id: str) -> Lesson:
        """Mark a lesson as standing and return it; call it only if `why_not_redo` returned None."""
        place = self._place[command_id]
        record = self._records[place] = replace(self._records[place], undone=False)
        self._standing_of.setdefault(lesson_stack(record.event), []).append(place)
        self._undone.remove(place)
        self.standing += 1
        spot = bisect_left(self._newest, place)
        if self._newest[spot : spot + 1] != [place]:
            self._newest.insert(spot, place)
        return record.event
