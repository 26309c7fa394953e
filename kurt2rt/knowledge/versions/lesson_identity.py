"""Identity of lessons across knowledge files that began as one."""

import json
import math
import zlib
from collections import Counter
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

from kurt2rt.core.rla.events import RlaCreated, RlaRewarded, TeachingEvent
from kurt2rt.core.rla.lesson_history import LessonRecord, LessonStack, lesson_stack
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.knowledge.journal.entry import StoredEntry
from kurt2rt.knowledge.journal.event_codec import encode_event
from kurt2rt.knowledge.journal.fold import fold_entries
from kurt2rt.knowledge.journal.journal import Journal

StackKey = tuple[str, str] | tuple[str, int, int]
"""Key of a lesson stack in any file: (level, name) of a situation, or, of the lesson that created the RLA,
(command id, content CRC-32, occurrence index from 0)."""

NO_STACK: StackKey = ("", "")
"""Key of events that are no lessons."""


class LessonKey(NamedTuple):
    """Key of an event in any file, whatever its command id there."""

    command_id: str
    """The one that it was first taught under."""
    content: int
    """CRC-32 of its content, without ids that belong to one file."""
    stack: StackKey
    is_reward: bool

    def free_command_id(self, taken: Container[str]) -> str:
        """Return a command id for the event in a file that uses those in `taken`."""
        name, other, number = self.command_id, f"{self.command_id}~{self.content:08x}", 0
        while name in taken:
            number += 1
            name = other if number == 1 else f"{other}-{number}"
        return name


@dataclass(frozen=True)
class KnowledgeContent:
    """Content of one file, read once."""

    journal: Journal
    """May be closed: only path and binding are used."""
    entries: tuple[StoredEntry, ...]
    system: RlaSystem
    """Fold of all entries with an infinite R."""

    @property
    def records(self) -> Mapping[str, LessonRecord]:
        """All lessons by command id."""
        return {record.event.origin.command_id: record for record in self.system.lessons}

    @cached_property
    def lesson_keys(self) -> Mapping[str, LessonKey]:
        """Keys of all lessons, in their order, by command id in this file."""
        keys, created = dict[str, LessonKey](), Counter[tuple[str, int]]()
        of_rla = dict[LessonStack, StackKey]()
        for record in self.system.lessons:
            lesson = record.event
            first, content = _as_first_taught(lesson)
            stack = lesson_stack(lesson)
            if isinstance(lesson, RlaCreated):
                of_rla[stack] = (first, content, created[first, content])
                created[first, content] += 1
            key = stack if isinstance(stack, tuple) else of_rla[stack]
            keys[lesson.origin.command_id] = LessonKey(first, content, key, isinstance(lesson, RlaRewarded))
        return keys

    @cached_property
    def stacks(self) -> Mapping[StackKey, LessonStack]:
        """All stacks that ever were, in their order, by key."""
        return {self.key_of(record).stack: lesson_stack(record.event) for record in self.system.lessons}

    @cached_property
    def rla_keys(self) -> Mapping[int, StackKey]:
        """Stack keys of all RLAs that ever lived, by RLA id in this file."""
        return {stack: key for key, stack in self.stacks.items() if isinstance(stack, int)}

    def key_of(self, record: LessonRecord) -> LessonKey:
        """Return the key of a lesson of this file."""
        return self.lesson_keys[record.event.origin.command_id]


def read_content(journal: Journal) -> KnowledgeContent:
    """Read all entries of a file and fold them.

    Raises KnowledgeError for a damaged row, or a lesson that does not fit those before it.
    """
    entries = tuple(journal.entries())
    return KnowledgeContent(journal, entries, fold_entries(journal, entries, radius=math.inf))


def event_key(event: TeachingEvent) -> LessonKey:
    """Return the key of an event that is no lesson."""
    return LessonKey(*_as_first_taught(event), NO_STACK, is_reward=False)


def with_command_id(event: TeachingEvent, command_id: str) -> TeachingEvent:
    """Return a copy of the event with another command id."""
    origin = replace(event.origin, command_id=command_id)
    if isinstance(event, RlaCreated):
        return RlaCreated(replace(event.rla, origin=origin))
    return replace(event, origin=origin)


def count_common_rows(one: Sequence[StoredEntry], other: Sequence[StoredEntry]) -> int:
    """Return the number of rows that both begin with, whatever their stamps."""
    same = 0
    for mine, theirs in zip(one, other, strict=False):
        if mine.event != theirs.event:
            break
        same += 1
    return same


def standing_stacks(
    lessons: Iterable[LessonRecord], lesson_keys: Mapping[str, LessonKey]
) -> dict[StackKey, tuple[LessonKey, ...]]:
    """Return the keys of the lessons that stand, by stack, the undermost first.

    `lesson_keys`: key of each lesson by command id.
    """
    stacks = dict[StackKey, tuple[LessonKey, ...]]()
    for record in lessons:
        if not record.undone:
            key = lesson_keys[record.event.origin.command_id]
            stacks[key.stack] = (*stacks.get(key.stack, ()), key)
    return stacks


def lessons_up_to(content: KnowledgeContent, rows: int) -> tuple[LessonRecord, ...]:
    """Return the lessons as they were after the first `rows` rows."""
    if rows == len(content.entries):
        return content.system.lessons
    system = RlaSystem(content.system.dimensions, math.inf)
    system.apply_all(entry.event for entry in content.entries[:rows])
    return system.lessons


def _as_first_taught(event: TeachingEvent) -> tuple[str, int]:
    """Return the command id of an event before any merge renamed it, and the CRC-32 of its content."""
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
