"""Deletion of RLAs that no recorded decision needs, after a replay proved that no decision changes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from kurt2rt.core.rla.events import RlaDeleted
from kurt2rt.core.rla.rla import BASIC, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import fold_entries
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.versions.editing import append_with_values, new_origin, open_for_editing, statistics_after
from kurt2rt.runs.replay.run import Run
from kurt2rt.runs.replay.trial import Report, TrialKnowledge, compatible_runs, format_answers, replay_answers

TEACHER = "compact"
"""Teacher of the deletions, so that all of them can be undone together."""


@dataclass(frozen=True, slots=True)
class Compaction:
    """Deletions, done or planned, and their evidence."""

    deleted: tuple[Rla, ...]
    kept: int
    """RLAs of the basic level that stay."""
    runs: int
    """Runs in which the robot drove."""
    ticks: int
    """Ticks of these runs."""
    driven_ticks: int
    """Ticks in which an action turned the wheels; a standing robot is evidence of one place only."""
    notes: tuple[str, ...]
    """Runs, or parts of one, that could not be replayed, with the reason."""
    other_behaviours: tuple[str, ...]
    """Taught behaviours that drove in no run; their RLAs stay for lack of evidence."""


@dataclass(slots=True)
class _Coverage:
    """RLAs and behaviours used in the runs."""

    needed: set[int] = field(default_factory=set)
    """Ids of all RLAs that were nearest in some tick, also while the robot stood."""
    behaviours: set[str] = field(default_factory=set)
    """Behaviours that drove."""
    runs: int = 0
    ticks: int = 0
    driven_ticks: int = 0
    standing: list[str] = field(default_factory=list)
    """Names of runs without a driven tick."""


def compact(path: Path, recordings: Path, *, stamp: str, dry_run: bool, report: Report) -> Compaction:
    """Delete the basic-level RLAs that no recorded decision needs, as durable lessons that can be undone.

    Args:
        path: of the knowledge file.
        recordings: folder of the runs, or one run.
        stamp: of the deletions, UTC, ISO 8601.
        dry_run: change nothing.
        report: progress callback.

    Raises:
        KnowledgeError: a robot runs on the file, no compatible run has a driven tick, or a decision would change;
            nothing is changed then.
        RecordingError: a run cannot be replayed.
    """
    if dry_run:
        with Journal.read_only(path) as journal:
            compaction, _ = _plan(journal, recordings, report)
        return compaction
    with open_for_editing(path) as journal:
        compaction, deletions = _plan(journal, recordings, report)
        if deletions:
            append_with_values(journal, [JournalEntry(event, stamp) for event in deletions])
    return compaction


def _plan(journal: Journal, recordings: Path, report: Report) -> tuple[Compaction, list[RlaDeleted]]:
    entries, statistics = journal.read_all()
    system = fold_entries(journal, entries, radius=math.inf)
    tried = compatible_runs(recordings, journal.binding)
    now = TrialKnowledge(tuple(entry.event for entry in entries), statistics)
    coverage = _replay_runs(system, tried.runs, now, report)
    if not coverage.driven_ticks:
        raise KnowledgeError(KnowledgeCode.NOTHING_DROVE, where=recordings, runs=len(tried.runs))
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
    """Raise KnowledgeError if an answer differs in its RLA, its distance or in asking."""
    for run in runs:
        for record, (old, new) in replay_answers(run, (before, after), report):
            if old != new:
                raise KnowledgeError(
                    KnowledgeCode.DECISION_WOULD_CHANGE,
                    where=run.name,
                    at_s=record.now_s,
                    new=format_answers(new),
                    old=format_answers(old),
                )
