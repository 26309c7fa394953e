"""A branch: a new knowledge file that begins as another one was, up to some lesson or time."""

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
from kurt2rt.knowledge.knowledge_error import KnowledgeError

_NOTE = "branch of"


@dataclass(frozen=True, slots=True)
class BranchOrigin:
    """Where a branch came from."""

    file: str
    """Name of the other file then."""
    rows: int
    """How many of its rows the branch began with."""
    lesson: str
    """Command id of the last of them; empty where there was none."""
    branched_at: str
    """UTC, ISO 8601."""


@dataclass(frozen=True, slots=True)
class BranchResult:
    """A branch that was made."""

    origin: BranchOrigin
    skipped_earlier: int
    """Rows that were left out though they are stamped by the time that was asked for: the clock was set back there."""


def branch(path: Path, new: Path, at: str | None, *, stamp: str) -> BranchResult:
    """Make `new` from the rows of `path` up to `at`: a lesson's command id, or a time (ISO 8601); None: all of them.

    Up to a time: up to the first row with a later stamp. Where the clock was set back, rows behind that one may bear
    earlier stamps; they stay out, for a branch is a beginning of the file, and nothing later may be in it.

    What was counted goes with all of them; up to an earlier row only what is about RLAs that are still the same, and
    worths begin anew from the rewards. Raises KnowledgeError.
    """
    with Journal.read_only(path) as journal:
        entries, statistics = journal.read_all()
        rows, skipped_earlier = (len(entries), 0) if at is None else _rows_up_to(entries, at, path)
        binding = journal.binding
        if rows < len(entries):
            then = fold_entries(journal, entries[:rows], radius=0.0)
            now = fold_entries(journal, entries, radius=0.0)
            statistics = _of_the_same(statistics, then, now, (BASIC, *binding.levels))
    last = entries[rows - 1].event.origin.command_id if rows else ""
    origin = BranchOrigin(path.name, rows, last, stamp)
    kept = [JournalEntry(entry.event, entry.stamped_at) for entry in entries[:rows]]
    note = json.dumps([origin.file, origin.rows, origin.lesson, origin.branched_at])
    create_knowledge(new, binding, kept, statistics, {_NOTE: note}, source=path)
    return BranchResult(origin, skipped_earlier)


def branch_origin(journal: Journal) -> BranchOrigin | None:
    """Where a file was branched from; None for one that was begun by itself. Raises KnowledgeError."""
    note = journal.notes().get(_NOTE)
    if note is None:
        return None
    try:
        file, rows, lesson, branched_at = json.loads(note)
        return BranchOrigin(str(file), int(rows), str(lesson), str(branched_at))
    except (ValueError, TypeError, RecursionError) as error:
        raise KnowledgeError(
            f"its note on where it was branched from is damaged ({error})", where=journal.path, do="keep the file"
        ) from error


def _rows_up_to(entries: Sequence[StoredEntry], at: str, path: Path) -> tuple[int, int]:
    """How many rows there are up to a lesson or time, and how many behind them are stamped by that time."""
    for entry in entries:
        if entry.event.origin.command_id == at:
            return entry.sequence, 0
    try:
        time = _time(at)
    except ValueError:
        raise KnowledgeError(
            f"holds no lesson {at!r}, and that is no time either",
            where=path,
            do="give an id as kurt2rt knowledge lessons shows it, or a time such as 2026-11-22T03:10",
        ) from None
    try:
        by_then = [_time(entry.stamped_at) <= time for entry in entries]
    except ValueError as error:
        raise KnowledgeError(
            f"the stamp of a lesson is no time ({error})", where=path, do="give the id of a lesson instead"
        ) from error
    rows = by_then.index(False) if False in by_then else len(by_then)
    return rows, sum(by_then[rows:])


def _time(text: str) -> datetime:
    """With its time zone, the local one where it does not say. Raises ValueError."""
    time = datetime.fromisoformat(text)
    return time.astimezone() if time.tzinfo is None else time


def _of_the_same(statistics: Statistics, then: RlaSystem, now: RlaSystem, levels: Sequence[str]) -> Statistics:
    """What is about RLAs that have the same action now as then, by the same lesson."""
    living: dict[int, Rla] = {rla.rla_id: rla for level in levels for rla in then.rlas_at(level)}
    same = {rla_id for rla_id, rla in living.items() if now.get(rla_id) == rla}
    first = statistics.numbers.get(FIRST_VALUE)
    return Statistics(
        uses={rla_id: count for rla_id, count in statistics.uses.items() if rla_id in same},
        transitions={edge: count for edge, count in statistics.transitions.items() if same.issuperset(edge)},
        numbers={} if first is None else {FIRST_VALUE: first},
        expectations={rla_id: each for rla_id, each in statistics.expectations.items() if rla_id in same},
    )
