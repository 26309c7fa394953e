"""Difference of two knowledge files: lessons that stand in one of them only, and RLAs."""

from collections.abc import Set as AbstractSet
from dataclasses import dataclass

from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import BASIC, Rla
from kurt2rt.knowledge.versions.lesson_identity import KnowledgeContent, LessonKey, count_common_rows


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


def compare(a: KnowledgeContent, b: KnowledgeContent) -> KnowledgeDiff:
    """Return the difference of two files of the same features. RLAs are the same if the same lesson created them."""
    rlas_a = {a.rla_keys[rla.rla_id]: rla for rla in active_rlas(a)}
    rlas_b = {b.rla_keys[rla.rla_id]: rla for rla in active_rlas(b)}
    return KnowledgeDiff(
        count_common_rows(a.entries, b.entries),
        _standing_only_in(a, _standing_keys(b)),
        _standing_only_in(b, _standing_keys(a)),
        tuple(rla for key, rla in rlas_a.items() if key not in rlas_b),
        tuple(rla for key, rla in rlas_b.items() if key not in rlas_a),
        tuple((rla, rlas_b[key]) for key, rla in rlas_a.items() if key in rlas_b and rlas_b[key].action != rla.action),
    )


def active_rlas(content: KnowledgeContent) -> list[Rla]:
    """Return all living RLAs of a file, level by level, the basic one first, and oldest first in each."""
    return [rla for level in (BASIC, *content.journal.binding.levels) for rla in content.system.rlas_at(level)]


def _standing_keys(content: KnowledgeContent) -> set[LessonKey]:
    return {content.key_of(record) for record in content.system.lessons if not record.undone}


def _standing_only_in(one: KnowledgeContent, other: AbstractSet[LessonKey]) -> tuple[LessonRecord, ...]:
    return tuple(record for record in one.system.lessons if not record.undone and one.key_of(record) not in other)
