"""How two knowledge files differ: lessons that stand in one of them only, and RLAs."""

from collections.abc import Set as AbstractSet
from dataclasses import dataclass

from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import BASIC, Rla
from kurt2rt.knowledge.versions.lesson_identity import KnowledgeContent, LessonKey, common_rows


@dataclass(frozen=True)
class KnowledgeDiff:
    """Of one file (a) and another (b)."""

    common_rows: int
    """How many rows both begin with."""
    lessons_a: tuple[LessonRecord, ...]
    """Those that stand in a and not in b, oldest first."""
    lessons_b: tuple[LessonRecord, ...]
    rlas_a: tuple[Rla, ...]
    """Those that live in a and not in b."""
    rlas_b: tuple[Rla, ...]
    changed: tuple[tuple[Rla, Rla], ...]
    """Those with another action: as in a, as in b."""

    @property
    def none(self) -> bool:
        """Whether both know the same, by the same lessons."""
        return not (self.lessons_a or self.lessons_b or self.rlas_a or self.rlas_b or self.changed)


def difference(a: KnowledgeContent, b: KnowledgeContent) -> KnowledgeDiff:
    """Compare two files of the same features: RLAs are the same where the same lesson made them."""
    stands_a = {a.lesson_keys[record.event.origin.command_id] for record in a.system.lessons if not record.undone}
    stands_b = {b.lesson_keys[record.event.origin.command_id] for record in b.system.lessons if not record.undone}
    rlas_a = {a.rla_keys[rla.rla_id]: rla for rla in living(a)}
    rlas_b = {b.rla_keys[rla.rla_id]: rla for rla in living(b)}
    return KnowledgeDiff(
        common_rows(a.entries, b.entries),
        _standing_only_in(a, stands_b),
        _standing_only_in(b, stands_a),
        tuple(rla for key, rla in rlas_a.items() if key not in rlas_b),
        tuple(rla for key, rla in rlas_b.items() if key not in rlas_a),
        tuple((rla, rlas_b[key]) for key, rla in rlas_a.items() if key in rlas_b and rlas_b[key].action != rla.action),
    )


def _standing_only_in(one: KnowledgeContent, other: AbstractSet[LessonKey]) -> tuple[LessonRecord, ...]:
    return tuple(
        record
        for record in one.system.lessons
        if not record.undone and one.lesson_keys[record.event.origin.command_id] not in other
    )


def living(taught: KnowledgeContent) -> list[Rla]:
    """All living RLAs, of all levels."""
    return [rla for level in (BASIC, *taught.journal.binding.levels) for rla in taught.system.rlas_at(level)]
