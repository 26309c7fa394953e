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
from kurt2rt.runs.replay.trial import Report, TrialKnowledge, compatible_runs, format_answers, replay_answers

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
class _Coverage:
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
            compaction, _ = _plan(journal, recordings, report)
        return compaction
    with open_for_editing(path) as journal:
        compaction, deletions = _plan(journal, recordings, report)
        if deletions:
            write(journal, [JournalEntry(event, stamp) for event in deletions])
    return compaction


def _plan(journal: Journal, recordings: Path, report: Report) -> tuple[Compaction, list[RlaDeleted]]:
    entries, statistics = journal.read_all()
    system = fold_entries(journal, entries, radius=math.inf)
    tried = compatible_runs(recordings, journal.binding)
    now = TrialKnowledge(tuple(entry.event for entry in entries), statistics)
    coverage = _replay_runs(system, tried.runs, now, report)
    if not coverage.driven_ticks:
        raise KnowledgeError(
            f"in none of its {len(tried.runs)} runs of such knowledge anything drove (0 s)",
            where=recordings,
            do="they prove nothing, and nothing was deleted: record a run in which the robot drives",
        )
    rlas = system.rlas_at(BASIC)
    unneeded = tuple(rla for rla in rlas if rla.behaviour in coverage.behaviours and rla.rla_id not in coverage.needed)
    deletions = [RlaDeleted(rla.rla_id, new_origin("compact", TEACHER)) for rla in unneeded]
    if deletions:
        after = statistics_after(now.events, deletions, now.statistics, len(journal.binding.feature_names))
        _require_unchanged(tried.runs, now, TrialKnowledge((*now.events, *deletions), after), report)
    notes = (*tried.notes, *(f"{run}: nothing drove in it, so it proves nothing" for run in coverage.standing))
    others = tuple(sorted({rla.behaviour for rla in rlas} - coverage.behaviours))
    kept = len(rlas) - len(unneeded)
    return Compaction(unneeded, kept, coverage.runs, coverage.ticks, coverage.driven_ticks, notes, others), deletions


def _replay_runs(system: RlaSystem, runs: Sequence[Run], now: TrialKnowledge, report: Report) -> _Coverage:
    coverage = _Coverage()
    for run in runs:
        ticks = driven_ticks = 0
        for record, (answered,) in replay_answers(run, (now,), report):
            ticks += 1
            if record.decision.driving and any(record.guard_result.wheel_speeds):
                driven_ticks += 1
                coverage.behaviours.add(record.behaviour)
            nearest = answered.basic.nearest
            if nearest is not None and nearest.rla_id not in coverage.needed:
                # Those that stand on its condition are chosen among by worth and chance: all of them stay.
                coverage.needed.update(rla.rla_id for rla in system.competitors(nearest))
        if driven_ticks:
            coverage.runs += 1
            coverage.ticks += ticks
            coverage.driven_ticks += driven_ticks
        else:
            coverage.standing.append(run.name)
    return coverage


def _require_unchanged(runs: Sequence[Run], before: TrialKnowledge, after: TrialKnowledge, report: Report) -> None:
    """Raises KnowledgeError where anything is said otherwise: which RLA, at what distance, or that it asks."""
    for run in runs:
        for record, (old, new) in replay_answers(run, (before, after), report):
            if old != new:
                change = f"{format_answers(new)}, and not {format_answers(old)}"
                raise KnowledgeError(
                    f"at {record.now_s:.2f} s the robot would do something else: {change}",
                    where=run.name,
                    do="nothing was deleted",
                )
