"""RLAs of a further level as a table: which circumstances the critic holds to be good or bad, and who taught it."""

from collections.abc import Iterable, Mapping

from kurt2rt.core.rla.rla import CRITIC, Rla
from kurt2rt.knowledge.journal.entry import StoredEntry
from kurt2rt.knowledge.show.table_cells import answer, instead_of, plain, stamp_and_teacher
from kurt2rt.platform.text_table import TextTable


def level_table(
    level: str, rlas: Iterable[Rla], feature_names: tuple[str, ...], taught: Mapping[str, StoredEntry]
) -> TextTable:
    """A row per RLA. `taught`: the entry of each command id."""
    of_critic = level == CRITIC
    table = TextTable()
    table.add_column("appraisal RLA" if of_critic else f"{level} RLA", number=True)
    table.add_column("says" if of_critic else "action")
    for heading in ("instead of", "taught (UTC), by", "circumstances" if of_critic else "features"):
        table.add_column(heading)
    for rla in rlas:
        entry = taught[rla.origin.command_id]
        table.add_row(
            str(rla.rla_id),
            answer(rla),
            instead_of(entry),
            stamp_and_teacher(entry.stamped_at, rla.origin.teacher),
            plain(_circumstances(rla, feature_names)),
        )
    return table


def _circumstances(rla: Rla, feature_names: tuple[str, ...]) -> str:
    """Those that are not 0, by name."""
    named = zip(feature_names, rla.condition, strict=True)
    return ", ".join(f"{name} {value:.2f}" for name, value in named if value) or "all 0"
