"""Which lessons were taught, and which of them still stand: what an undo may take back."""

from bisect import bisect_left
from dataclasses import dataclass, replace

from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.rla.rla import (
    ASK,
    BASIC,
    ActionReplaced,
    ActionWithdrawn,
    Lesson,
    RlaCreated,
    RlaDeleted,
    RlaLesson,
    RlaRewarded,
    SituationNamed,
    rla_title,
)

LessonStack = int | tuple[str, str]
"""What lessons are about, and stand on one another for: an RLA by its id, or a level and a name."""


@dataclass(frozen=True, slots=True)
class LessonRecord:
    """A lesson, and whether it was taken back."""

    event: Lesson
    undone: bool = False
    behaviour: str = ""
    """The taught behaviour of its RLA; empty where the task has only one, or it is about none."""
    level: str = BASIC
    """The level that it is about."""

    @property
    def text(self) -> str:
        """In a few words, for a teacher."""
        if isinstance(self.event, SituationNamed):
            return f"situation named: {self.event.name}"
        rla = rla_title(rla_id_of(self.event), self.behaviour, self.level)
        match self.event:
            case RlaCreated(taught):
                return f"{rla} taught: {taught.action}"
            case ActionReplaced(_, action, instead_of, _):
                if instead_of == ASK:
                    return f"{rla} answered anew: {action}"
                return f"{rla} corrected: {action} instead of {instead_of}"
            case ActionWithdrawn():
                return f"{rla} withdrawn: it asks again"
            case RlaDeleted():
                return f"{rla} deleted"
            case RlaRewarded(value=value):
                return f"{rla} {'rewarded' if value > 0 else 'punished'}"


def rla_id_of(lesson: RlaLesson) -> int:
    """Id of the RLA that a lesson is about."""
    return lesson.rla.rla_id if isinstance(lesson, RlaCreated) else lesson.rla_id


def lesson_stack(lesson: Lesson) -> LessonStack:
    """Lessons of one pile are undone in the order of the pile: all about one RLA, or all that gave one name."""
    return (lesson.level, lesson.name) if isinstance(lesson, SituationNamed) else rla_id_of(lesson)


class LessonHistory:
    """All lessons by their command id.

    Those about one RLA, and those that gave one name, are undone in the order of a pile, the newest first.
    """

    def __init__(self) -> None:
        self.standing = 0
        """Number of lessons that stand."""
        self._records: list[LessonRecord] = []
        self._place: dict[str, int] = {}
        self._places_of: dict[LessonStack, list[int]] = {}
        """Of all lessons of a pile, those that do not stand among them."""
        self._standing_of: dict[LessonStack, list[int]] = {}
        self._home_of: dict[int, tuple[str, str]] = {}
        """Behaviour and level of each RLA that ever lived."""
        self._newest: list[int] = []
        """Places of all lessons but the undone ones at the end, ascending."""
        self._below: list[int | None] = []
        """Of each lesson: the place of the one that it was put on in its pile."""
        self._undone: list[int] = []
        """Places of the lessons that do not stand, in the order in which they were undone."""

    @property
    def records(self) -> tuple[LessonRecord, ...]:
        """All lessons, oldest first, those that were undone among them."""
        return tuple(self._records)

    @property
    def last_standing(self) -> str | None:
        """Command id of the newest lesson that stands."""
        return self._records[self._newest[-1]].event.origin.command_id if self._newest else None

    @property
    def last_undone(self) -> str | None:
        """Command id of the lesson that was undone last, of those that do not stand."""
        return self._records[self._undone[-1]].event.origin.command_id if self._undone else None

    def get(self, command_id: str) -> LessonRecord | None:
        """The lesson of that command."""
        place = self._place.get(command_id)
        return None if place is None else self._records[place]

    def about(self, pile: LessonStack) -> tuple[LessonRecord, ...]:
        """All lessons about an RLA, or that gave a name, oldest first, those that were undone among them."""
        return tuple(self._records[place] for place in self._places_of.get(pile, ()))

    def first_about(self, pile: LessonStack) -> LessonRecord:
        """The oldest of these. Raises KeyError where there is none."""
        return self._records[self._places_of[pile][0]]

    def add(self, lesson: Lesson) -> None:
        """Put a lesson behind all others. Its command id must be new."""
        place = len(self._records)
        self._place[lesson.origin.command_id] = place
        pile = self._standing_of.setdefault(lesson_stack(lesson), [])
        self._below.append(pile[-1] if pile else None)
        pile.append(place)
        self._places_of.setdefault(lesson_stack(lesson), []).append(place)
        self._newest.append(place)
        if isinstance(lesson, RlaCreated):
            self._home_of[lesson.rla.rla_id] = (lesson.rla.behaviour, lesson.rla.level)
        behaviour, level = (
            ("", lesson.level) if isinstance(lesson, SituationNamed) else self._home_of[rla_id_of(lesson)]
        )
        self._records.append(LessonRecord(lesson, behaviour=behaviour, level=level))
        self.standing += 1

    def why_not_undo(self, command_id: str) -> Outcome | None:
        """Return why the lesson of that command cannot be taken back now; None if it can."""
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

    def undo(self, command_id: str) -> Lesson:
        """Mark a lesson as undone, for which `why_not_undo` has no reason against it; returns it."""
        place = self._place[command_id]
        record = self._records[place]
        lesson = record.event
        pile = self._standing_of[lesson_stack(lesson)]
        pile.pop()
        if not pile:
            del self._standing_of[lesson_stack(lesson)]
        self._records[place] = replace(record, undone=True)
        self._undone.append(place)
        self.standing -= 1
        while self._newest and self._records[self._newest[-1]].undone:
            self._newest.pop()
        return lesson

    def why_not_redo(self, command_id: str) -> Outcome | None:
        """Return why the lesson of that command cannot stand again; None if it can.

        It can where its RLA, or its name, is again as the lesson found it.
        """
        record = self.get(command_id)
        if record is None:
            return Outcome.of(RefusalCode.NO_SUCH_LESSON, lesson=command_id)
        if not record.undone:
            return Outcome.of(RefusalCode.STANDS_ALREADY, lesson=command_id)
        below = self._below[self._place[command_id]]
        pile = self._standing_of.get(lesson_stack(record.event))
        top = pile[-1] if pile else None
        if top == below:
            return None
        if below is not None and self._records[below].undone:
            was = self._records[below]
            earlier = was.event.origin.command_id
            return Outcome.of(RefusalCode.STANDS_ON_UNDONE, lesson=command_id, earlier=earlier, says=was.text)
        assert top is not None  # nothing below it is undone, so it is something above that is in the way
        newest = self._records[top]
        later = newest.event.origin.command_id
        return Outcome.of(RefusalCode.TAUGHT_INSTEAD, later=later, lesson=command_id, says=newest.text)

    def redo(self, command_id: str) -> Lesson:
        """Mark a lesson as standing, for which `why_not_redo` has no reason against it; returns it."""
        place = self._place[command_id]
        record = self._records[place] = replace(self._records[place], undone=False)
        self._standing_of.setdefault(lesson_stack(record.event), []).append(place)
        self._undone.remove(place)
        self.standing += 1
        spot = bisect_left(self._newest, place)
        if self._newest[spot : spot + 1] != [place]:
            self._newest.insert(spot, place)
        return record.event
