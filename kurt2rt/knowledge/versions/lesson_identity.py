"""Two knowledge files that began as one: which lesson of the one is which of the other."""

import json
import math
import zlib
from collections import Counter
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

from kurt2rt.core.rla.lesson_history import LessonRecord, LessonStack, lesson_stack
from kurt2rt.core.rla.rla import RlaCreated, RlaRewarded, TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.knowledge.journal.entry import StoredEntry
from kurt2rt.knowledge.journal.event_codec import encode_event
from kurt2rt.knowledge.journal.fold import fold_entries
from kurt2rt.knowledge.journal.journal import Journal

StackKey = tuple[str, str] | tuple[str, int, int]
"""A pile in whichever file: a level and a name, or what created its RLA, and the how manieth of such it was."""

NO_STACK: StackKey = ("", "")
"""Of events that are no lessons."""


class LessonKey(NamedTuple):
    """Which event it is, in whichever file, and however it is called there."""

    command_id: str
    """The one that it was taught under."""
    content: int
    """CRC-32 of what it says, without ids that are of its file."""
    stack: StackKey
    is_reward: bool

    def name(self, taken: Container[str]) -> str:
        """Command id for it in a file where those are taken."""
        name, other, number = self.command_id, f"{self.command_id}~{self.content:08x}", 0
        while name in taken:
            number += 1
            name = other if number == 1 else f"{other}-{number}"
        return name


@dataclass(frozen=True)
class KnowledgeContent:
    """What one file holds, read once."""

    journal: Journal
    """Closed, maybe: only its path and binding count."""
    entries: tuple[StoredEntry, ...]
    system: RlaSystem
    """The fold of all entries; nothing is within reach or out of it there."""

    @property
    def records(self) -> Mapping[str, LessonRecord]:
        """All lessons by their command id."""
        return {record.event.origin.command_id: record for record in self.system.lessons}

    @cached_property
    def lesson_keys(self) -> Mapping[str, LessonKey]:
        """Of all lessons, in their order, by the command id that they have here."""
        lesson_keys, created = dict[str, LessonKey](), Counter[tuple[str, int]]()
        of_rla = dict[LessonStack, StackKey]()
        for record in self.system.lessons:
            lesson = record.event
            first, content = _as_first_taught(lesson)
            stack = lesson_stack(lesson)
            if isinstance(lesson, RlaCreated):
                of_rla[stack] = (first, content, created[first, content])
                created[first, content] += 1
            key = stack if isinstance(stack, tuple) else of_rla[stack]
            lesson_keys[lesson.origin.command_id] = LessonKey(first, content, key, isinstance(lesson, RlaRewarded))
        return lesson_keys

    @cached_property
    def stacks(self) -> Mapping[StackKey, LessonStack]:
        """All piles that ever were, in their order."""
        return {
            self.lesson_keys[record.event.origin.command_id].stack: lesson_stack(record.event)
            for record in self.system.lessons
        }

    @cached_property
    def rla_keys(self) -> Mapping[int, StackKey]:
        """Of all RLAs that ever lived, by their ids here."""
        return {stack: key for key, stack in self.stacks.items() if isinstance(stack, int)}


def read_content(journal: Journal) -> KnowledgeContent:
    """Read a file whole. Raises KnowledgeError."""
    entries = tuple(journal.entries())
    return KnowledgeContent(journal, entries, fold_entries(journal, entries, radius=math.inf))


def event_key(event: TeachingEvent) -> LessonKey:
    """Of an event that is no lesson."""
    return LessonKey(*_as_first_taught(event), NO_STACK, is_reward=False)


def named(event: TeachingEvent, command_id: str) -> TeachingEvent:
    """The same event by another command id."""
    origin = replace(event.origin, command_id=command_id)
    if isinstance(event, RlaCreated):
        return RlaCreated(replace(event.rla, origin=origin))
    return replace(event, origin=origin)


def common_rows(one: Sequence[StoredEntry], other: Sequence[StoredEntry]) -> int:
    """How many rows both begin with; when each was written does not matter."""
    same = 0
    for mine, theirs in zip(one, other, strict=False):
        if mine.event != theirs.event:
            break
        same += 1
    return same


def standing_stacks(
    lessons: Iterable[LessonRecord], lesson_keys: Mapping[str, LessonKey]
) -> dict[StackKey, tuple[LessonKey, ...]]:
    """The lessons that stand, by what they are about; the order in which each was put on the other."""
    stacks = dict[StackKey, tuple[LessonKey, ...]]()
    for record in lessons:
        if not record.undone:
            key = lesson_keys[record.event.origin.command_id]
            stacks[key.stack] = (*stacks.get(key.stack, ()), key)
    return stacks


def lessons_up_to(taught: KnowledgeContent, rows: int) -> tuple[LessonRecord, ...]:
    """The lessons as they were when the file had that many rows."""
    if rows == len(taught.entries):
        return taught.system.lessons
    system = RlaSystem(taught.system.dimensions, math.inf)
    system.apply_all(entry.event for entry in taught.entries[:rows])
    return system.lessons


def _as_first_taught(event: TeachingEvent) -> tuple[str, int]:
    """Command id that an event was taught under, before it was brought anywhere, and the CRC-32 of its content."""
    first = event.origin.command_id
    content = _content(event, first)
    while "~" in first:
        before, _, check = first.rpartition("~")
        of_before = _content(event, before)
        if check.partition("-")[0] != f"{of_before:08x}":
            break
        first, content = before, of_before
    return first, content


def _content(event: TeachingEvent, command_id: str) -> int:
    content = json.loads(encode_event(event)) | {"command_id": command_id}
    for of_its_file in ("version", "rla_id", "credits"):
        content.pop(of_its_file, None)
    return zlib.crc32(json.dumps(content, sort_keys=True).encode())
