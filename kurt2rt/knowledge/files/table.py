"""Table of the living RLAs for spreadsheets and scripts: one row each, comma-separated."""

import csv
import io
import math
from collections.abc import Mapping
from pathlib import Path
from unicodedata import normalize

from kurt2rt.core.rla.rla import BASIC, Rla
from kurt2rt.knowledge.files.atomic_write import SavedCopy, plain_part, stamp_part, write_numbered
from kurt2rt.knowledge.journal.fold import fold_entries
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.platform.yield_gil import yield_gil

_COLUMNS = (
    *("id", "action", "radius", "teacher", "phase", "tick", "taught_at"),
    *("uses", "rewards", "punishments", "value", "level"),
)
_FORMULA_BEGINS = "=+-@\t\r\n"
"""A spreadsheet runs a cell that begins so as a formula, also from a CSV file (OWASP, "CSV injection")."""


def export_table(journal_path: Path, folder: Path, stamp: str) -> SavedCopy:
    """Save `<task>-<stamp>-rlas.csv`: a row per RLA, oldest first, with a column per feature of its condition.

    The basic level comes first; features of a further level with RLAs have columns of their own, such as `critic:
    speed_m_s`. An empty radius is that of the system; an RLA without rewards has an empty value. Taught behaviours have
    a column if one has a name. Numbers are exact, text is UTF-8. A text that a spreadsheet would run as a formula gets
    an apostrophe before it. The call waits for the disk.

    Raises:
        KnowledgeError: the file at `journal_path` cannot be read, or the table not be written.
    """
    with Journal.in_writer_process(journal_path) as journal:
        task = journal.binding.system
        content = _table(journal).encode()
    return write_numbered(content, folder, (plain_part(task), stamp_part(stamp), "rlas"), ".csv")


def _table(journal: Journal) -> str:
    # Lessons first: statistics read later may know more RLAs than are shown, never fewer.
    entries = list(yield_gil(journal.iter_entries()))
    system = fold_entries(journal, yield_gil(entries), radius=math.inf)
    statistics = journal.statistics()
    stamps = {entry.event.origin.command_id: entry.stamped_at for entry in entries}
    text = io.StringIO(newline="")
    table = csv.writer(text)
    levels = {BASIC: journal.binding.feature_names} | {
        level: features.feature_names for level, features in journal.binding.levels.items() if system.rlas_at(level)
    }
    rlas = [rla for level in levels for rla in system.rlas_at(level)]
    named = any(rla.behaviour for rla in rlas)
    behaviour_column = ("behaviour",) if named else ()
    table.writerow(map(_harmless, (*_COLUMNS, *behaviour_column, *_feature_columns(levels))))
    for rla in yield_gil(rlas):
        origin = rla.origin
        cells = (
            rla.rla_id,
            rla.action,
            rla.radius,
            origin.teacher,
            origin.phase.value,
            origin.tick,
            stamps[origin.command_id],
            statistics.uses.get(rla.rla_id, 0),
            *system.appraisal(rla.rla_id),
            statistics.values.get(rla.rla_id),
            rla.level,
            *((rla.behaviour,) if named else ()),
            *_under_its_columns(rla, levels),
        )
        table.writerow(map(_harmless, cells))
    return text.getvalue()


def _harmless(cell: str | float | None) -> str | float | None:
    """Return the cell, quoted by an apostrophe if it is a text that begins as a formula and is no number."""
    if not isinstance(cell, str) or normalize("NFKC", cell[:1]) not in tuple(_FORMULA_BEGINS):
        return cell
    try:
        float(cell)
    except ValueError:
        return f"'{cell}"
    return cell


def _feature_columns(levels: Mapping[str, tuple[str, ...]]) -> list[str]:
    return [name if level == BASIC else f"{level}: {name}" for level, names in levels.items() for name in names]


def _under_its_columns(rla: Rla, levels: Mapping[str, tuple[str, ...]]) -> list[float | None]:
    cells: list[float | None] = []
    for level, names in levels.items():
        cells.extend(rla.condition if level == rla.level else [None] * len(names))
    return cells
