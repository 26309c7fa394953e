"""Deletes the RLAs that no recorded decision needs, once a replay has proved that not one decision changes by it."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from kurt2rt.care.trial import Known, Report, answers, runs_to_try, told
from kurt2rt.knowledge.changing import new_origin, open_again, worths_after, write
from kurt2rt.knowledge.entry import JournalEntry
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.kinship import Taught, read_taught
from kurt2rt.replay.run import Run
from kurt2rt.rla.rla import BASIC, Rla, RlaDeleted

TEACHER = "compact"
"""Whose lessons the deletions are: all of them can be undone together."""


@dataclass(frozen=True, slots=True)
class Compaction:
    """What was deleted, or would be."""

    deleted: tuple[Rla, ...]
    kept: int
    """RLAs of the basic level that stay."""
    runs: int
    ticks: int
    """That were tried."""
    notes: tuple[str, ...]
    """Which runs, or parts of one, could not be tried, and why."""
    other_behaviours: tuple[str, ...]
    """Taught behaviours that no run wanted: their RLAs stay, for nothing is known of them."""


def compact(path: Path, recordings: Path, *, stamp: str, dry_run: bool, report: Report) -> Compaction:
    """Delete what no decision of the recorded runs needs, as lessons that can be undone; durable on return.

    Only RLAs of the basic level. Raises KnowledgeError, and changes nothing, where a robot runs on the file, there are
    no runs of such knowledge, or any decision of them would change.
    """
    if dry_run:
        with Journal.read_only(path) as journal:
            compaction, _ = _planned(journal, recordings, report)
        return compaction
    with open_again(path) as journal:
        compaction, deletions = _planned(journal, recordings, report)
        if deletions:
            write(journal, [JournalEntry(event, stamp) for event in deletions])
    return compaction


def _planned(journal: Journal, recordings: Path, report: Report) -> tuple[Compaction, list[RlaDeleted]]:
    taught = read_taught(journal)
    tried = runs_to_try(recordings, journal.binding)
    runs = tried.runs
    now = Known(tuple(entry.event for entry in taught.entries), journal.statistics())
    needed, behaviours, ticks = _needed(taught, runs, now, report)
    rlas = taught.system.rlas_at(BASIC)
    # A run in which nobody could be asked passes over those that ask: it does not tell whether one is needed.
    unneeded = tuple(rla for rla in rlas if rla.behaviour in behaviours and rla.rla_id not in needed and not rla.asks)
    deletions = [RlaDeleted(rla.rla_id, new_origin("compact", TEACHER)) for rla in unneeded]
    if deletions:
        after = worths_after(now.events, deletions, now.statistics, len(journal.binding.feature_names))
        _prove(runs, now, Known((*now.events, *deletions), after), report)
    others = tuple(sorted({rla.behaviour for rla in rlas} - behaviours))
    return Compaction(unneeded, len(rlas) - len(unneeded), len(runs), ticks, tried.notes, others), deletions


def _needed(taught: Taught, runs: Sequence[Run], now: Known, report: Report) -> tuple[set[int], set[str], int]:
    """Ids of all RLAs that were ever nearest, the taught behaviours that were wanted, and the number of ticks."""
    needed, behaviours, ticks = set[int](), set[str](), 0
    for run in runs:
        for record, (answered,) in answers(run, (now,), report):
            ticks += 1
            behaviours.add(record.behaviour)
            nearest = answered.basic.nearest
            if nearest is not None and nearest.rla_id not in needed:
                # Those that stand on its condition are chosen among by worth and chance: all of them stay.
                needed.update(rla.rla_id for rla in taught.system.competitors(nearest))
    return needed, behaviours, ticks


def _prove(runs: Sequence[Run], before: Known, after: Known, report: Report) -> None:
    """Raises KnowledgeError where anything is said otherwise: which RLA, at what distance, or that it asks."""
    for run in runs:
        for record, (old, new) in answers(run, (before, after), report):
            if old != new:
                raise KnowledgeError(
                    f"{run.name}: at {record.now_s:.2f} s the robot would do something else: {told(new)}, and not "
                    f"{told(old)}; nothing was deleted"
                )
