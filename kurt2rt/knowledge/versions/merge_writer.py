"""Journal rows (undo, redo, new lessons) that apply a merge plan to one knowledge file."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from kurt2rt.core.outcome_text import event_error_text
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.event_error import InvalidEventError
from kurt2rt.core.rla.events import (
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
from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.versions.editing import new_origin
from kurt2rt.knowledge.versions.lesson_identity import (
    NO_STACK,
    KnowledgeContent,
    LessonKey,
    StackKey,
    event_key,
    with_command_id,
)


@dataclass(frozen=True, slots=True)
class TargetStack:
    """One stack: the lessons that stand on it here, and those that shall."""

    stack: StackKey
    now: tuple[LessonKey, ...]
    then: tuple[LessonKey, ...]

    @property
    def same(self) -> int:
        """Number of lessons at the bottom that stay as they are."""
        for place, (now, then) in enumerate(zip(self.now, self.then, strict=False)):
            if now != then:
                return place
        return min(len(self.now), len(self.then))


class LeftOutCode(StrEnum):
    """Reason why a merge leaves a reward as it is."""

    RLA_GONE = "rla gone"
    """The rewarded RLA is not in this file."""
    OTHER_ACTION = "other action"
    """The RLA has another action here than the rewarded one."""
    BURIED = "buried"
    """The reward was undone there, but lessons taught here since lie on it."""


@dataclass(frozen=True, slots=True)
class LeftOutReward:
    """Reward that a merge neither brings nor undoes."""

    code: LeftOutCode
    record: LessonRecord
    action: str | None = None
    """Action that the reward was given for; None if it is unknown."""
    rla: Rla | None = None
    """The RLA as it is in this file, for OTHER_ACTION."""


class MergeWriter:
    """Collector of the rows that a merge writes; applies them to the fold of mine, and changes neither file."""

    def __init__(self, mine: KnowledgeContent, theirs: KnowledgeContent, *, teacher: str, stamp: str) -> None:
        """Prepare; `teacher` and `stamp` are those of undos and redos, lessons keep their own."""
        self.entries: list[JournalEntry] = []
        self.left_out: list[LeftOutReward] = []
        """Rewards of theirs that are not brought."""
        self.new_ids: dict[int, int] = {}
        """RLA id there -> here, of the RLAs that it creates."""
        self._mine, self._theirs = mine, theirs
        self._system = mine.system
        self._teacher, self._stamp = teacher, stamp
        self._taken = {entry.event.origin.command_id for entry in mine.entries}
        self._rlas = {
            rla_id: here for rla_id, key in theirs.rla_keys.items() if isinstance(here := mine.stacks.get(key), int)
        }
        self._names = {key: list[str]() for key in mine.lesson_keys.values()}
        for name, key in mine.lesson_keys.items():
            self._names[key].append(name)
        self._stamps = {entry.event.origin.command_id: entry.stamped_at for entry in theirs.entries}
        self._own_stamps = {entry.event.origin.command_id: entry.stamped_at for entry in mine.entries}
        self._own = {mine.key_of(record): record.event for record in mine.system.lessons}
        self._standing = {theirs.key_of(record): record for record in theirs.system.lessons if not record.undone}
        self._actions = _actions_when_rewarded(theirs)

    @property
    def rlas(self) -> Mapping[int, int]:
        """Id in theirs -> id in mine, of all RLAs that are in both files."""
        return self._rlas

    def name_of(self, key: LessonKey) -> str | None:
        """Return the newest command id of a lesson in mine; None if mine lacks the lesson."""
        names = self._names.get(key)
        return names[-1] if names else None

    def write(self, wanted: Sequence[TargetStack], deletions: Iterable[int]) -> None:
        """Add undos, newest lesson first, then deletions, then lessons in the order in which they were taught there.

        Raises:
            KnowledgeError: one of them does not fit.
        """
        place = {name: number for number, name in enumerate(self._mine.lesson_keys)}
        removed = [self._standing_name(key) for each in wanted for key in each.now[each.same :]]
        for name in sorted(removed, key=lambda name: -place[name]):
            self._add(LessonUndone(name, new_origin("undo", self._teacher)), self._stamp)
        for rla_id in dict.fromkeys(deletions):
            self._add(RlaDeleted(rla_id, new_origin("delete", self._teacher)), self._stamp)
        queues = {each.stack: list(each.then[each.same :]) for each in wanted}
        for key in list(self._standing):
            queue = queues.get(key.stack, [])
            while key in queue:  # lessons beneath it go first
                self._restore(queue.pop(0))
        for queue in queues.values():
            for key in queue:
                self._restore(key)

    def write_sessions(self) -> None:
        """Add sessions and agreements of theirs that mine lacks. Raises KnowledgeError if one does not fit."""
        kinds = SessionBegun | SessionEnded | Appraised
        here = {event_key(entry.event) for entry in self._mine.entries if isinstance(entry.event, kinds)}
        for entry in self._theirs.entries:
            if isinstance(entry.event, kinds):
                key = event_key(entry.event)
                if key not in here:
                    assert key.stack == NO_STACK
                    self._add(with_command_id(entry.event, key.free_command_id(self._taken)), entry.stamped_at)

    def _restore(self, key: LessonKey) -> None:
        """Put a lesson on its stack: redo it if that is possible, else add it as a new lesson."""
        for name in reversed(self._names.get(key, [])):
            if self._system.why_not_redo(name) is None:
                self._add(LessonRedone(name, new_origin("redo", self._teacher)), self._stamp)
                return
        name = key.free_command_id(self._taken)
        if key in self._own and not (key.is_reward and key in self._standing):
            before = self._own[key]
            self._add(with_command_id(before, name), self._own_stamps[before.origin.command_id])
        else:
            record = self._standing[key]
            lesson = self._translate(record.event)
            if lesson is None:
                self.left_out.append(self._left_out(record))
                return
            self._add(with_command_id(lesson, name), self._stamps[record.event.origin.command_id])
        self._names.setdefault(key, []).append(name)

    def _translate(self, lesson: Lesson) -> Lesson | None:
        """Return a lesson of theirs with RLA ids of this file; None for a reward of an action the RLA has not here.

        Credits of RLAs that are not here, or have another action here, are left out.
        """
        match lesson:
            case RlaCreated(rla):
                here = self.new_ids[rla.rla_id] = self._rlas[rla.rla_id] = self._system.next_id
                return RlaCreated(replace(rla, rla_id=here))
            case SituationNamed():
                return lesson
            case RlaRewarded(rla_id, credits=credits_):
                then = self._actions[lesson.origin.command_id]
                if not self._has_action(rla_id, then):
                    return None
                kept = tuple(
                    Credit(self._rlas[each.rla_id], each.change, each.before and self._rlas[each.before])
                    for each in credits_
                    if self._has_action(each.rla_id, then)
                    and (each.before is None or self._has_action(each.before, then))
                )
                return replace(lesson, rla_id=self._rlas[rla_id], credits=kept)
            case _:
                return replace(lesson, rla_id=self._rlas[lesson.rla_id])

    def _has_action(self, rla_id: int, then: Mapping[int, str]) -> bool:
        here = self._system.get(self._rlas.get(rla_id, 0))
        return here is not None and here.action == then.get(rla_id)

    def _left_out(self, record: LessonRecord) -> LeftOutReward:
        lesson = record.event
        assert isinstance(lesson, RlaRewarded)
        action = self._actions[lesson.origin.command_id].get(lesson.rla_id)
        here = self._system.get(self._rlas.get(lesson.rla_id, 0))
        code = LeftOutCode.RLA_GONE if here is None else LeftOutCode.OTHER_ACTION
        return LeftOutReward(code, record, action, here)

    def _standing_name(self, key: LessonKey) -> str:
        for name in self._names[key]:
            record = self._system.lesson(name)
            if record is not None and not record.undone:
                return name
        raise AssertionError(key)

    def _add(self, event: TeachingEvent, stamp: str) -> None:
        try:
            self._system.apply(event)
        except InvalidEventError as error:
            into, where = self._mine.journal.path.name, self._theirs.journal.path
            raise KnowledgeError(
                KnowledgeCode.MERGE_MISFIT, where=where, into=into, error=event_error_text(error)
            ) from error
        self._taken.add(event.origin.command_id)
        self.entries.append(JournalEntry(event, stamp))


def _actions_when_rewarded(content: KnowledgeContent) -> dict[str, dict[int, str]]:
    """Return the actions of the RLAs that each reward was about, by its command id and RLA id."""
    system, found = RlaSystem(content.system.dimensions, 0.0), dict[str, dict[int, str]]()
    for entry in content.entries:
        event = entry.event
        if isinstance(event, RlaRewarded):
            meant = [event.rla_id]
            for credit in event.credits:
                meant += [credit.rla_id] if credit.before is None else [credit.rla_id, credit.before]
            rlas = {rla_id: system.get(rla_id) for rla_id in meant}
            found[event.origin.command_id] = {rla_id: rla.action for rla_id, rla in rlas.items() if rla is not None}
        system.apply(event)
    return found
