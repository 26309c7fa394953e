"""How two knowledge files differ: lessons that stand in one of them only, and RLAs."""

from dataclasses import dataclass

from kurt2rt.knowledge.kinship import Taught, common_rows, kinship_of
from kurt2rt.rla.lesson_book import LessonRecord
from kurt2rt.rla.rla import BASIC, Rla


@dataclass(frozen=True)
class Difference:
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


def difference(a: Taught, b: Taught) -> Difference:
    """Compare two files of the same features: RLAs are the same where the same lesson made them."""
    kinship = kinship_of(a, b)
    stands_a = {record.event.origin.command_id: record for record in a.system.lessons if not record.undone}
    stands_b = {
        kinship.lessons.get(record.event.origin.command_id): record for record in b.system.lessons if not record.undone
    }
    rlas_a = {rla.rla_id: rla for rla in living(a)}
    rlas_b = {kinship.rlas.get(rla.rla_id, -rla.rla_id): rla for rla in living(b)}
    return Difference(
        common_rows(a.entries, b.entries),
        tuple(record for name, record in stands_a.items() if name not in stands_b),
        tuple(
            record
            for record in b.system.lessons
            if not record.undone and kinship.lessons.get(record.event.origin.command_id) not in stands_a
        ),
        tuple(rla for rla_id, rla in rlas_a.items() if rla_id not in rlas_b),
        tuple(rla for rla_id, rla in rlas_b.items() if rla_id not in rlas_a),
        tuple(
            (rla, rlas_b[rla_id])
            for rla_id, rla in rlas_a.items()
            if rla_id in rlas_b and rlas_b[rla_id].action != rla.action
        ),
    )


def living(taught: Taught) -> list[Rla]:
    """All living RLAs, of all levels."""
    return [rla for level in (BASIC, *taught.journal.binding.levels) for rla in taught.system.rlas_at(level)]
