"""Makes piles of one knowledge file what a merge wants them to be: undos, lessons that stand again, and new ones."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from kurt2rt.core.outcome_text import event_error_text
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import (
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
from kurt2rt.core.rla.rla_system import InvalidEventError, RlaSystem
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.versions.editing import new_origin
from kurt2rt.knowledge.versions.lesson_identity import NO_STACK, KnowledgeContent, LessonKey, StackKey, event_key, named


@dataclass(frozen=True, slots=True)
class TargetStack:
    """One pile: what stands on it here, and what shall."""

    stack: StackKey
    now: tuple[LessonKey, ...]
    then: tuple[LessonKey, ...]

    @property
    def same(self) -> int:
        """How many lessons at the bottom stay as they are."""
        for place, (now, then) in enumerate(zip(self.now, self.then, strict=False)):
            if now != then:
                return place
        return min(len(self.now), len(self.then))


class MergeWriter:
    """Finds the rows that a merge writes; applies them to the fold of mine, and changes neither file."""

    def __init__(self, mine: KnowledgeContent, theirs: KnowledgeContent, *, teacher: str, stamp: str) -> None:
        """`teacher` and `stamp` of what is undone or redone by it; lessons keep those that they have."""
        self.entries: list[JournalEntry] = []
        self.left_out: list[str] = []
        """Praise and blame that is not brought, in words."""
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

    @property
    def rlas(self) -> Mapping[int, int]:
        """RLA id there -> here, of all that are in both."""
        return self._rlas

    def name_of(self, key: LessonKey) -> str | None:
        """Command id of a lesson here, the newest where it was brought again; None where it is not here."""
        names = self._names.get(key)
        return names[-1] if names else None

    def write(self, wanted: Sequence[TargetStack], deletions: Iterable[int]) -> None:
        """Undos, the newest lesson first, deletions, then lessons in the order in which they were taught there.

        Raises KnowledgeError where they do not fit.
        """
        own = {self._mine.lesson_keys[name]: record.event for name, record in _by_name(self._mine)}
        place = {name: number for number, name in enumerate(self._mine.lesson_keys)}
        taken_off = [self._standing(key) for each in wanted for key in each.now[each.same :]]
        for name in sorted(taken_off, key=lambda name: -place[name]):
            self._add(LessonUndone(name, new_origin("undo", self._teacher)), self._stamp)
        for rla_id in dict.fromkeys(deletions):
            self._add(RlaDeleted(rla_id, new_origin("delete", self._teacher)), self._stamp)
        queues = {each.stack: list(each.then[each.same :]) for each in wanted}
        standing = {
            self._theirs.lesson_keys[name]: record for name, record in _by_name(self._theirs) if not record.undone
        }
        actions = _actions_when_rewarded(self._theirs)
        for key in list(standing):
            queue = queues.get(key.stack, [])
            while key in queue:  # one that was put in before it goes first
                self._put(queue.pop(0), standing, own, actions)
        for queue in queues.values():
            for key in queue:
                self._put(key, standing, own, actions)

    def write_sessions(self) -> None:
        """Sessions and agreements that are not here."""
        kinds = SessionBegun | SessionEnded | Appraised
        here = {event_key(entry.event) for entry in self._mine.entries if isinstance(entry.event, kinds)}
        for entry in self._theirs.entries:
            if isinstance(entry.event, kinds):
                key = event_key(entry.event)
                if key not in here:
                    assert key.stack == NO_STACK
                    self._add(named(entry.event, key.name(self._taken)), entry.stamped_at)

    def _put(
        self,
        key: LessonKey,
        standing: Mapping[LessonKey, LessonRecord],
        own: Mapping[LessonKey, Lesson],
        actions: Mapping[str, Mapping[int, str]],
    ) -> None:
        """Let a lesson stand on its pile: again, where that can be, else as a new one."""
        for name in reversed(self._names.get(key, [])):
            if self._system.why_not_redo(name) is None:
                self._add(LessonRedone(name, new_origin("redo", self._teacher)), self._stamp)
                return
        name = key.name(self._taken)
        if key in own and not (key.is_reward and key in standing):
            before = own[key]
            self._add(named(before, name), self._own_stamps[before.origin.command_id])
        else:
            record = standing[key]
            lesson = self._here(record.event, actions)
            if lesson is None:
                self.left_out.append(self._why_left_out(record, actions))
                return
            self._add(named(lesson, name), self._stamps[record.event.origin.command_id])
        self._names.setdefault(key, []).append(name)

    def _here(self, lesson: Lesson, actions: Mapping[str, Mapping[int, str]]) -> Lesson | None:
        """A lesson of theirs as it is here; None for praise or blame of another action than the RLA has here.

        Credits of RLAs that are not here, or have another action, are left out likewise.
        """
        match lesson:
            case RlaCreated(rla):
                here = self.new_ids[rla.rla_id] = self._rlas[rla.rla_id] = self._system.next_id
                return RlaCreated(replace(rla, rla_id=here))
            case SituationNamed():
                return lesson
            case RlaRewarded(rla_id, credits=credits_):
                then = actions[lesson.origin.command_id]
                if not self._says_still(rla_id, then):
                    return None
                kept = tuple(
                    Credit(self._rlas[each.rla_id], each.change, each.before and self._rlas[each.before])
                    for each in credits_
                    if self._says_still(each.rla_id, then)
                    and (each.before is None or self._says_still(each.before, then))
                )
                return replace(lesson, rla_id=self._rlas[rla_id], credits=kept)
            case _:
                return replace(lesson, rla_id=self._rlas[lesson.rla_id])

    def _says_still(self, rla_id: int, then: Mapping[int, str]) -> bool:
        here = self._system.get(self._rlas.get(rla_id, 0))
        return here is not None and here.action == then.get(rla_id)

    def _why_left_out(self, record: LessonRecord, actions: Mapping[str, Mapping[int, str]]) -> str:
        lesson = record.event
        assert isinstance(lesson, RlaRewarded)
        meant = actions[lesson.origin.command_id].get(lesson.rla_id)
        here = self._system.get(self._rlas.get(lesson.rla_id, 0))
        says = "is gone here" if here is None else f"is {here.title} here and says {here.action}"
        return f"{record.text} there by {lesson.origin.teacher} for {meant}; it {says}"

    def _standing(self, key: LessonKey) -> str:
        for name in self._names[key]:
            record = self._system.lesson(name)
            if record is not None and not record.undone:
                return name
        raise AssertionError(key)

    def _add(self, event: TeachingEvent, stamp: str) -> None:
        try:
            self._system.apply(event)
        except InvalidEventError as error:
            raise KnowledgeError(
                f"cannot be brought into {self._mine.journal.path.name}: {event_error_text(error)}",
                where=self._theirs.journal.path,
                do="undo there what is in the way, or go on in one of them",
            ) from error
        self._taken.add(event.origin.command_id)
        self.entries.append(JournalEntry(event, stamp))


def _by_name(taught: KnowledgeContent) -> list[tuple[str, LessonRecord]]:
    return [(record.event.origin.command_id, record) for record in taught.system.lessons]


def _actions_when_rewarded(taught: KnowledgeContent) -> dict[str, dict[int, str]]:
    """What the RLAs said that praise or blame was meant for, by its command id and theirs."""
    system, found = RlaSystem(taught.system.dimensions, 0.0), dict[str, dict[int, str]]()
    for entry in taught.entries:
        event = entry.event
        if isinstance(event, RlaRewarded):
            meant = [event.rla_id]
            for credit in event.credits:
                meant += [credit.rla_id] if credit.before is None else [credit.rla_id, credit.before]
            rlas = {rla_id: system.get(rla_id) for rla_id in meant}
            found[event.origin.command_id] = {rla_id: rla.action for rla_id, rla in rlas.items() if rla is not None}
        system.apply(event)
    return found
