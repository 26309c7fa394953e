"""What an undo would have changed in recorded runs."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from kurt2rt.care.trial import Known, Report, Runs, Stretch, differing, runs_to_try
from kurt2rt.knowledge.changing import worths_after
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.kinship import read_taught
from kurt2rt.knowledge.undo import lesson_to_undo, lessons_to_undo, undos_of
from kurt2rt.rla.lesson_book import LessonRecord


@dataclass(frozen=True)
class Preview:
    """An undo that was not made."""

    lessons: tuple[LessonRecord, ...]
    """What would be taken back, in this order."""
    runs: Runs
    stretches: Iterator[Stretch]
    """Read them once: they come while the runs are replayed."""


def preview_undo(path: Path, lesson: str | None, of: str | None, recordings: Path, report: Report) -> Preview:
    """Try an undo of one lesson (None: the last that stands), or of all of the teacher `of`; changes nothing.

    Raises KnowledgeError as the undo would, and where there are no runs to try it on.
    """
    with Journal.read_only(path) as journal:
        taught, statistics = read_taught(journal), journal.statistics()
    system = taught.system
    lessons = [lesson_to_undo(system, lesson, path)] if of is None else lessons_to_undo(system, of, path)
    undos = undos_of(system, lessons, "preview", lambda problem: KnowledgeError(f"{path}: {problem}"))
    runs = runs_to_try(recordings, taught.journal.binding)
    events = tuple(entry.event for entry in taught.entries)
    dimensions = len(taught.journal.binding.feature_names)
    before = Known(events, statistics)
    after = Known((*events, *undos), worths_after(events, undos, statistics, dimensions))
    records = taught.records
    return Preview(tuple(records[name] for name in lessons), runs, differing(runs.runs, before, after, report))
