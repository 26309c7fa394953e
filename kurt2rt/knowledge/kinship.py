"""Two knowledge files that began as one: where they part, and which lesson of the one is which of the other."""

import json
import math
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from kurt2rt.knowledge.entry import StoredEntry
from kurt2rt.knowledge.events import encode_event
from kurt2rt.knowledge.fold import fold_entries
from kurt2rt.knowledge.journal import Journal
from kurt2rt.rla.lesson_book import LessonRecord, Pile, pile_of
from kurt2rt.rla.rla import (
    ActionReplaced,
    ActionWithdrawn,
    Credit,
    KnowledgeMerged,
    Lesson,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    SituationNamed,
    TeachingEvent,
)
from kurt2rt.rla.rla_system import RlaSystem


@dataclass(frozen=True)
class Taught:
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


def read_taught(journal: Journal) -> Taught:
    """Read a file whole. Raises KnowledgeError."""
    entries = tuple(journal.entries())
    return Taught(journal, entries, fold_entries(journal, entries, radius=math.inf))


def common_rows(one: Sequence[StoredEntry], other: Sequence[StoredEntry]) -> int:
    """How many rows both begin with; when each was written does not matter."""
    same = 0
    for mine, theirs in zip(one, other, strict=False):
        if mine.event != theirs.event:
            break
        same += 1
    return same


def known_rows(mine: Sequence[StoredEntry], theirs: Sequence[StoredEntry]) -> int:
    """How many rows of `theirs` were taken account of in `mine`: the common ones, or all up to the last merge."""
    known = common_rows(mine, theirs)
    for entry in mine:
        event = entry.event
        if (
            isinstance(event, KnowledgeMerged)
            and known < event.rows <= len(theirs)
            and theirs[event.rows - 1].event.origin.command_id == event.last
        ):
            known = event.rows
    return known


def standing_piles(lessons: Iterable[LessonRecord]) -> dict[Pile, tuple[str, ...]]:
    """Command ids of the lessons that stand, by what they are about; the order in which each was put on the other."""
    piles: dict[Pile, tuple[str, ...]] = {}
    for record in lessons:
        if not record.undone:
            pile = pile_of(record.event)
            piles[pile] = (*piles.get(pile, ()), record.event.origin.command_id)
    return piles


@dataclass
class Kinship:
    """How lessons and RLAs of another file (theirs) are called in this one (mine)."""

    lessons: dict[str, str] = field(default_factory=dict)
    """Command id there -> here, of the lessons that are in both."""
    rlas: dict[int, int] = field(default_factory=dict)
    """RLA id there -> here, of those that were created in both, whether they live or not."""
    taken: frozenset[str] = frozenset()
    """All command ids of mine."""

    def pile(self, theirs: Pile) -> Pile | None:
        """The same pile here; None for an RLA that is not here."""
        return self.rlas.get(theirs) if isinstance(theirs, int) else theirs

    def name_for(self, lesson: Lesson) -> str:
        """Command id under which a lesson of theirs is, or would be, here: its own, where no other one has that."""
        own = lesson.origin.command_id
        if own in self.lessons:
            return self.lessons[own]
        return own if own not in self.taken else _another_name(lesson)

    def here(self, lesson: Lesson, command_id: str, new_id: int | None = None) -> Lesson:
        """A lesson of theirs as it is here, its RLA under its id here: `new_id` for one that it creates.

        Raises KeyError for an RLA that is not here. Credits of such ones are left out.
        """
        origin = replace(lesson.origin, command_id=command_id)
        match lesson:
            case RlaCreated(rla):
                rla_id = self.rlas[rla.rla_id] if new_id is None else new_id
                return RlaCreated(replace(rla, rla_id=rla_id, origin=origin))
            case RlaRewarded():
                credits_ = tuple(
                    Credit(self.rlas[each.rla_id], each.change, each.before and self.rlas[each.before])
                    for each in lesson.credits
                    if each.rla_id in self.rlas and (each.before is None or each.before in self.rlas)
                )
                return replace(lesson, rla_id=self.rlas[lesson.rla_id], origin=origin, credits=credits_)
            case ActionReplaced() | ActionWithdrawn() | RlaDeleted():
                return replace(lesson, rla_id=self.rlas[lesson.rla_id], origin=origin)
            case SituationNamed():
                return replace(lesson, origin=origin)


def kinship_of(mine: Taught, theirs: Taught) -> Kinship:
    """Find each lesson of theirs in mine: in the common beginning, or brought over by a merge in either direction."""
    here = {record.event.origin.command_id: record.event for record in mine.system.lessons}
    kinship = Kinship(taken=frozenset(entry.event.origin.command_id for entry in mine.entries))
    for record in theirs.system.lessons:
        lesson = record.event
        own = lesson.origin.command_id
        for name in (own, _another_name(lesson)):
            same = here.get(name)
            if same is not None and _is_same(lesson, same, kinship, name):
                kinship.lessons[own] = name
                if isinstance(lesson, RlaCreated) and isinstance(same, RlaCreated):
                    kinship.rlas[lesson.rla.rla_id] = same.rla.rla_id
                break
    return kinship


def _is_same(theirs: Lesson, mine: Lesson, kinship: Kinship, name: str) -> bool:
    new_id = mine.rla.rla_id if isinstance(mine, RlaCreated) and isinstance(theirs, RlaCreated) else None
    try:
        return _told(kinship.here(theirs, name, new_id)) == _told(mine)
    except KeyError:
        return False


def _told(lesson: TeachingEvent) -> TeachingEvent:
    """Without its credits: those of RLAs that are not here were left out."""
    return replace(lesson, credits=()) if isinstance(lesson, RlaRewarded) else lesson


def _another_name(lesson: Lesson) -> str:
    """A command id that is the same whenever this lesson is brought where its own id is another one's."""
    content = json.loads(encode_event(lesson))
    for of_its_file in ("version", "rla_id", "credits"):
        content.pop(of_its_file, None)
    return f"{lesson.origin.command_id}~{zlib.crc32(json.dumps(content, sort_keys=True).encode()):08x}"
