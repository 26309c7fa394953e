"""Two knowledge files that began as one: which lesson of the one is which of the other."""

import json
import math
import zlib
from collections import Counter
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

from kurt2rt.core.rla.lesson_history import LessonRecord, Pile, pile_of
from kurt2rt.core.rla.rla import RlaCreated, RlaRewarded, TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.knowledge.journal.entry import StoredEntry
from kurt2rt.knowledge.journal.event_codec import encode_event
from kurt2rt.knowledge.journal.fold import fold_entries
from kurt2rt.knowledge.journal.journal import Journal

PileMark = tuple[str, str] | tuple[str, int, int]
"""A pile in whichever file: a level and a name, or what created its RLA, and the how manieth of such it was."""

NO_PILE: PileMark = ("", "")
"""Of events that are no lessons."""


class LessonKey(NamedTuple):
    """Which event it is, in whichever file, and however it is called there."""

    command_id: str
    """The one that it was taught under."""
    content: int
    """CRC-32 of what it says, without ids that are of its file."""
    pile: PileMark
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
    def marks(self) -> Mapping[str, LessonKey]:
        """Of all lessons, in their order, by the command id that they have here."""
        marks, created = dict[str, LessonKey](), Counter[tuple[str, int]]()
        of_rla = dict[Pile, PileMark]()
        for record in self.system.lessons:
            lesson = record.event
            first, content = _as_first_taught(lesson)
            pile = pile_of(lesson)
            if isinstance(lesson, RlaCreated):
                of_rla[pile] = (first, content, created[first, content])
                created[first, content] += 1
            mark = pile if isinstance(pile, tuple) else of_rla[pile]
            marks[lesson.origin.command_id] = LessonKey(first, content, mark, isinstance(lesson, RlaRewarded))
        return marks

    @cached_property
    def piles(self) -> Mapping[PileMark, Pile]:
        """All piles that ever were, in their order."""
        return {
            self.marks[record.event.origin.command_id].pile: pile_of(record.event) for record in self.system.lessons
        }

    @cached_property
    def rla_marks(self) -> Mapping[int, PileMark]:
        """Of all RLAs that ever lived, by their ids here."""
        return {pile: mark for mark, pile in self.piles.items() if isinstance(pile, int)}


def read_taught(journal: Journal) -> KnowledgeContent:
    """Read a file whole. Raises KnowledgeError."""
    entries = tuple(journal.entries())
    return KnowledgeContent(journal, entries, fold_entries(journal, entries, radius=math.inf))


def mark_of(event: TeachingEvent) -> LessonKey:
    """Of an event that is no lesson."""
    return LessonKey(*_as_first_taught(event), NO_PILE, is_reward=False)


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


def standing_piles(
    lessons: Iterable[LessonRecord], marks: Mapping[str, LessonKey]
) -> dict[PileMark, tuple[LessonKey, ...]]:
    """The lessons that stand, by what they are about; the order in which each was put on the other."""
    piles = dict[PileMark, tuple[LessonKey, ...]]()
    for record in lessons:
        if not record.undone:
            mark = marks[record.event.origin.command_id]
            piles[mark.pile] = (*piles.get(mark.pile, ()), mark)
    return piles


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
