"""What an undo would have changed in recorded runs."""

import math
from dataclasses import dataclass
from pathlib import Path

from kurt2rt.care.trial import REPORT_EVERY, Known, Report, runs_to_try
from kurt2rt.knowledge.changing import worths_after
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.fold import fold_entries
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.undo import lesson_to_undo, lessons_to_undo, undos_of
from kurt2rt.replay.counterfactual import Counterfactual, counterfactual
from kurt2rt.replay.replay import ReplayedTick
from kurt2rt.replay.run import Run
from kurt2rt.replay.shadow import Shadow
from kurt2rt.rla.lesson_book import LessonRecord


@dataclass(frozen=True, slots=True)
class Tried:
    """What an undo would have changed in one run."""

    run: str
    found: Counterfactual


@dataclass(frozen=True)
class Preview:
    """An undo that was not made."""

    lessons: tuple[LessonRecord, ...]
    """What would be taken back, in this order."""
    runs: tuple[Tried, ...]
    notes: tuple[str, ...]
    """Which runs, or parts of one, could not be tried, and why."""


def preview_undo(path: Path, lesson: str | None, of: str | None, recordings: Path, report: Report) -> Preview:
    """Try an undo of one lesson (None: the last that stands), or of all of the teacher `of`; changes nothing.

    Raises KnowledgeError as the undo would, and where there are no runs to try it on.
    """
    with Journal.read_only(path) as journal:
        binding = journal.binding
        entries, statistics = journal.read_all()
        system = fold_entries(journal, entries, radius=math.inf)
    lessons = [lesson_to_undo(system, lesson, path)] if of is None else lessons_to_undo(system, of, path)
    undos = undos_of(system, lessons, "preview", lambda problem: KnowledgeError(f"{path}: {problem}"))
    runs = runs_to_try(recordings, binding)
    events = tuple(entry.event for entry in entries)
    dimensions = len(binding.feature_names)
    before = Known(events, statistics)
    after = Known((*events, *undos), worths_after(events, undos, statistics, dimensions))
    records = {record.event.origin.command_id: record for record in system.lessons}
    tried = tuple(_tried(run, before, after, report) for run in runs.runs)
    return Preview(tuple(records[name] for name in lessons), tried, runs.notes)


def _tried(run: Run, before: Known, after: Known, report: Report) -> Tried:
    def on_tick(tick: ReplayedTick) -> None:
        if tick.entry.number % REPORT_EVERY == 1:
            report(run.name, tick.entry.number)

    old, new = (Shadow(run, each.events, each.statistics) for each in (before, after))
    found = counterfactual(run, new, old, on_tick)
    return Tried(run.name, found)
