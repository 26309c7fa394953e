"""The RLAs that stand as a table for spreadsheets and scripts: one row each, comma-separated."""

import csv
import io
import math
from pathlib import Path

from kurt2rt.knowledge.fold import fold_entries
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.politely import politely
from kurt2rt.knowledge.saved_copy import SavedCopy, plain_part, save_whole, stamp_part

_COLUMNS = ("id", "action", "radius", "teacher", "phase", "tick", "taught_at", "uses", "rewards", "punishments")


def export_table(journal_path: Path, folder: Path, stamp: str) -> SavedCopy:
    """Save `<task>-<stamp>-rlas.csv`: a row per RLA, oldest first, with a column per feature of its condition.

    An empty radius is that of the system; taught behaviours have a column where one has a name. Numbers are exact.
    UTF-8. Waits and raises as `save_copy`.
    """
    with Journal.beside_its_writer(journal_path) as journal:
        task = journal.binding.system
        content = _table(journal).encode()
    return save_whole(content, folder, (plain_part(task), stamp_part(stamp), "rlas"), ".csv")


def _table(journal: Journal) -> str:
    # Lessons first: statistics read later may know more RLAs than are shown, never fewer.
    entries = list(politely(journal.each_entry()))
    system = fold_entries(journal, politely(entries), radius=math.inf)
    uses = journal.statistics().uses
    stamps = {entry.event.origin.command_id: entry.stamped_at for entry in entries}
    text = io.StringIO(newline="")
    table = csv.writer(text)
    rlas = system.rlas
    named = any(rla.behaviour for rla in rlas)
    behaviour_column = ("behaviour",) if named else ()
    table.writerow((*_COLUMNS, *behaviour_column, *journal.binding.feature_names))
    for rla in politely(rlas):
        origin = rla.origin
        table.writerow(
            (
                rla.rla_id,
                rla.action,
                rla.radius,
                origin.teacher,
                origin.phase.value,
                origin.tick,
                stamps[origin.command_id],
                uses.get(rla.rla_id, 0),
                *system.appraisal(rla.rla_id),
                *((rla.behaviour,) if named else ()),
                *rla.condition,
            )
        )
    return text.getvalue()
