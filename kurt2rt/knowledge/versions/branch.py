"""Branch: a new knowledge file with the first rows of another one, up to a lesson or time."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from kurt2rt.core.rla.rla import BASIC, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import FIRST_VALUE, Statistics
from kurt2rt.knowledge.files.create import create_knowledge
from kurt2rt.knowledge.journal.entry import JournalEntry, StoredEntry
from kurt2rt.knowledge.journal.fold import fold_entries
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError

_NOTE = "branch of"


@dataclass(frozen=True, slots=True)
class BranchOrigin:
    """File and row that a branch began with."""

    file: str
    """Name of the other file then."""
    rows: int
    """Number of its rows that the branch began with."""
    lesson: str
    """Command id of the last of them; empty if there was none."""
    branched_at: str
    """UTC, ISO 8601."""


@dataclass(frozen=True, slots=True)
class BranchResult:
    """A branch that was made."""

    origin: BranchOrigin
    skipped_earlier: int
    """Rows left out although they are stamped before the time asked for: the clock was set back before them."""


def branch(path: Path, new: Path, at: str | None, *, stamp: str) -> BranchResult:
    """Make the file `new` from the rows of `path` up to `at`.

    A time selects the rows before the first one with a later stamp. If the clock was set back, later rows may have
    earlier stamps; they are left out, because a branch is a beginning of the file.

    Statistics are copied whole with all rows. Up to an earlier row only those about RLAs that are still the same are
    copied, and values are learnt again from the rewards.

    Args:
        path: of the knowledge file.
        new: of the branch; no file may be there.
        at: command id of the last lesson, or a time (ISO 8601); None: all rows.
        stamp: of the branch, UTC, ISO 8601.

    Raises:
        KnowledgeError: `at` is neither a lesson nor a time, or one of the files fails.
    """
    with Journal.read_only(path) as journal:
        entries, statistics = journal.read_all()
        rows, skipped_earlier = (len(entries), 0) if at is None else _rows_up_to(entries, at, path)
        binding = journal.binding
        if rows < len(entries):
            then = fold_entries(journal, entries[:rows], radius=0.0)
            now = fold_entries(journal, entries, radius=0.0)
            statistics = _about_unchanged(statistics, then, now, (BASIC, *binding.levels))
    last = entries[rows - 1].event.origin.command_id if rows else ""
    origin = BranchOrigin(path.name, rows, last, stamp)
    kept = [JournalEntry(entry.event, entry.stamped_at) for entry in entries[:rows]]
    note = json.dumps([origin.file, origin.rows, origin.lesson, origin.branched_at])
    create_knowledge(new, binding, kept, statistics, {_NOTE: note}, source=path)
    return BranchResult(origin, skipped_earlier)


def branch_origin(journal: Journal) -> BranchOrigin | None:
    """Return the file and row that a branch was made from; None for a file that is no branch.

    Raises KnowledgeError.
    """
    note = journal.notes().get(_NOTE)
    if note is None:
        return None
    try:
        file, rows, lesson, branched_at = json.loads(note)
        return BranchOrigin(str(file), int(rows), str(lesson), str(branched_at))
    except (ValueError, TypeError, RecursionError) as error:
        raise KnowledgeError(KnowledgeCode.BRANCH_NOTE_DAMAGED, where=journal.path, error=error) from error


def _rows_up_to(entries: Sequence[StoredEntry], at: str, path: Path) -> tuple[int, int]:
    """Return the number of rows up to a lesson or time, and of later rows that are stamped before that time."""
    for entry in entries:
        if entry.event.origin.command_id == at:
            return entry.sequence, 0
    try:
        time = _time(at)
    except ValueError:
        raise KnowledgeError(KnowledgeCode.NO_SUCH_POINT, where=path, given=at) from None
    try:
        by_then = [_time(entry.stamped_at) <= time for entry in entries]
    except ValueError as error:
        raise KnowledgeError(KnowledgeCode.STAMP_INVALID, where=path, error=error) from error
    rows = by_then.index(False) if False in by_then else len(by_then)
    return rows, sum(by_then[rows:])


def _time(text: str) -> datetime:
    """Return a time with time zone, by default the local one. Raises ValueError."""
    time = datetime.fromisoformat(text)
    return time.astimezone() if time.tzinfo is None else time


def _about_unchanged(statistics: Statistics, then: RlaSystem, now: RlaSystem, levels: Sequence[str]) -> Statistics:
    """Return the statistics about RLAs that have the same action now as then, by the same lesson, and teachers."""
    active: dict[int, Rla] = {rla.rla_id: rla for level in levels for rla in then.rlas_at(level)}
    same = {rla_id for rla_id, rla in active.items() if now.get(rla_id) == rla}
    first = statistics.numbers.get(FIRST_VALUE)
    return Statistics(
        uses={rla_id: count for rla_id, count in statistics.uses.items() if rla_id in same},
        transitions={edge: count for edge, count in statistics.transitions.items() if same.issuperset(edge)},
        numbers={} if first is None else {FIRST_VALUE: first},
        expectations={rla_id: each for rla_id, each in statistics.expectations.items() if rla_id in same},
        answer_delays=statistics.answer_delays,
    )
