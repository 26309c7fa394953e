"""Difference of two knowledge files: lessons that stand in one of them only, and RLAs."""

import math
from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass

from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import BASIC, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.knowledge.journal.entry import StoredEntry
from kurt2rt.knowledge.journal.fold import fold_entries
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.versions.lesson_identity import LessonKey, lesson_keys


@dataclass(frozen=True)
class KnowledgeDiff:
    """Difference of a file a and a file b."""

    common_rows: int
    """Number of rows that both begin with."""
    lessons_a: tuple[LessonRecord, ...]
    """Those that stand in a and not in b, oldest first."""
    lessons_b: tuple[LessonRecord, ...]
    rlas_a: tuple[Rla, ...]
    """Those that live in a and not in b."""
    rlas_b: tuple[Rla, ...]
    changed: tuple[tuple[Rla, Rla], ...]
    """Those with another action: as in a, as in b."""

    @property
    def is_empty(self) -> bool:
        """Return whether both files have the same RLAs by the same lessons."""
        return not (self.lessons_a or self.lessons_b or self.rlas_a or self.rlas_b or self.changed)


def compare(a: Journal, b: Journal) -> KnowledgeDiff:
    """Return the difference of two files of the same features. RLAs are the same if the same lesson created them.

    Raises KnowledgeError for a damaged row, or a lesson that does not fit those before it.
    """
    rows_a, rows_b = a.entries(), b.entries()
    in_a, in_b = _Content(a, rows_a), _Content(b, rows_b)
    both = [(rla, in_b.rlas[key]) for key, rla in in_a.rlas.items() if key in in_b.rlas]
    return KnowledgeDiff(
        _count_common_rows(rows_a, rows_b),
        in_a.standing_but_for(in_b.standing.keys()),
        in_b.standing_but_for(in_a.standing.keys()),
        tuple(rla for key, rla in in_a.rlas.items() if key not in in_b.rlas),
        tuple(rla for key, rla in in_b.rlas.items() if key not in in_a.rlas),
        tuple((here, there) for here, there in both if here.action != there.action),
    )


class _Content:
    """Lessons that stand in a file, and its living RLAs, by keys that are the same in both files."""

    def __init__(self, journal: Journal, entries: Sequence[StoredEntry]) -> None:
        system = fold_entries(journal, entries, radius=math.inf)
        keys = lesson_keys(system)
        self.standing: Mapping[LessonKey, LessonRecord] = {
            keys[record.event.origin.command_id]: record for record in system.lessons if not record.undone
        }
        levels = (BASIC, *journal.binding.levels)
        self.rlas: Mapping[LessonKey, Rla] = {
            keys[_creation(system, rla)]: rla for level in levels for rla in system.rlas_at(level)
        }

    def standing_but_for(self, others: AbstractSet[LessonKey]) -> tuple[LessonRecord, ...]:
        return tuple(record for key, record in self.standing.items() if key not in others)


def _creation(system: RlaSystem, rla: Rla) -> str:
    return system.lessons_about(rla.rla_id)[0].event.origin.command_id


def _count_common_rows(one: Sequence[StoredEntry], other: Sequence[StoredEntry]) -> int:
    """Return the number of rows that both begin with, whatever their stamps."""
    same = 0
    for mine, theirs in zip(one, other, strict=False):
        if mine.event != theirs.event:
            break
        same += 1
    return same
