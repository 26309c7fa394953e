"""Deletes the RLAs that no recorded decision needs, once a replay has proved that not one decision changes by it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from kurt2rt.core.rla.rla import BASIC, Rla, RlaDeleted
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import fold_entries
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.versions.editing import new_origin, open_for_editing, statistics_after, write
from kurt2rt.runs.replay.run import Run
from kurt2rt.runs.replay.trial import Report, TrialKnowledge, answers, runs_to_try, told

TEACHER = "compact"
"""Whose lessons the deletions are: all of them can be undone together."""


@dataclass(frozen=True, slots=True)
class Compaction:
    """What was deleted, or would be."""

    deleted: tuple[Rla, ...]
    kept: int
    """RLAs of the basic level that stay."""
    runs: int
    """In which something drove."""
    ticks: int
    """Of these runs."""
    driven_ticks: int
    """Of these: an action turned the wheels. What stands sees one place, and proves nothing of others."""
    notes: tuple[str, ...]
    """Which runs, or parts of one, could not be tried, and why."""
    other_behaviours: tuple[str, ...]
    """Taught behaviours by which nothing drove in any run: their RLAs stay, for nothing is known of them."""


@dataclass(slots=True)
class _Seen:
    """What was seen in the runs."""

    needed: set[int] = field(default_factory=set)
    """Ids of all RLAs that were ever nearest, also while the robot stood."""
    behaviours: set[str] = field(default_factory=set)
    """By which something drove."""
    runs: int = 0
    ticks: int = 0
    driven_ticks: int = 0
    standing: list[str] = field(default_factory=list)
    """Names of runs in which nothing drove."""


def compact(path: Path, recordings: Path, *, stamp: str, dry_run: bool, report: Report) -> Compaction:
    """Delete what no decision of the recorded runs needs, as lessons that can be undone; durable on return.

    Only RLAs of the basic level. Raises KnowledgeError, and changes nothing, where a robot runs on the file, there are
    no runs of such knowledge in which anything drove, or any decision of them would change.
    """
    if dry_run:
        with Journal.read_only(path) as journal:
            compaction, _ = _planned(journal, recordings, report)
        return compaction
    with open_for_editing(path) as journal:
        compaction, deletions = _planned(journal, recordings, report)
        if deletions:
            write(journal, [JournalEntry(event, stamp) for event in deletions])
    return compaction


def _planned(journal: Journal, recordings: Path, report: Report) -> tuple[Compaction, list[RlaDeleted]]:
    entries, statistics = journal.read_all()
    system = fold_entries(journal, entries, radius=math.inf)
    tried = runs_to_try(recordings, journal.binding)
    now = TrialKnowledge(tuple(entry.event for entry in entries), statistics)
    seen = _look(system, tried.runs, now, report)
    if not seen.driven_ticks:
        raise KnowledgeError(
            f"in none of its {len(tried.runs)} runs of such knowledge anything drove (0 s)",
            where=recordings,
            do="they prove nothing, and nothing was deleted: record a run in which the robot drives",
        )
    rlas = system.rlas_at(BASIC)
    unneeded = tuple(rla for rla in rlas if rla.behaviour in seen.behaviours and rla.rla_id not in seen.needed)
    deletions = [RlaDeleted(rla.rla_id, new_origin("compact", TEACHER)) for rla in unneeded]
    if deletions:
        after = statistics_after(now.events, deletions, now.statistics, len(journal.binding.feature_names))
        _prove(tried.runs, now, TrialKnowledge((*now.events, *deletions), after), report)
    notes = (*tried.notes, *(f"{run}: nothing drove in it, so it proves nothing" for run in seen.standing))
    others = tuple(sorted({rla.behaviour for rla in rlas} - seen.behaviours))
    kept = len(rlas) - len(unneeded)
    return Compaction(unneeded, kept, seen.runs, seen.ticks, seen.driven_ticks, notes, others), deletions


def _look(system: RlaSystem, runs: Sequence[Run], now: TrialKnowledge, report: Report) -> _Seen:
    seen = _Seen()
    for run in runs:
        ticks = driven_ticks = 0
        for record, (answered,) in answers(run, (now,), report):
            ticks += 1
            if record.decision.driving and any(record.guard_result.wheel_speeds):
                driven_ticks += 1
                seen.behaviours.add(record.behaviour)
            nearest = answered.basic.nearest
            if nearest is not None and nearest.rla_id not in seen.needed:
                # Those that stand on its condition are chosen among by worth and chance: all of them stay.
                seen.needed.update(rla.rla_id for rla in system.competitors(nearest))
        if driven_ticks:
            seen.runs += 1
            seen.ticks += ticks
            seen.driven_ticks += driven_ticks
        else:
            seen.standing.append(run.name)
    return seen


def _prove(runs: Sequence[Run], before: TrialKnowledge, after: TrialKnowledge, report: Report) -> None:
    """Raises KnowledgeError where anything is said otherwise: which RLA, at what distance, or that it asks."""
    for run in runs:
        for record, (old, new) in answers(run, (before, after), report):
            if old != new:
                raise KnowledgeError(
                    f"at {record.now_s:.2f} s the robot would do something else: {told(new)}, and not {told(old)}",
                    where=run.name,
                    do="nothing was deleted",
                )
