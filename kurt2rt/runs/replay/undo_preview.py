"""Preview of an undo or redo on recorded runs."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.versions.editing import statistics_after
from kurt2rt.knowledge.versions.undo import UndoPlan
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.replay.counterfactual import Counterfactual, counterfactual
from kurt2rt.runs.replay.counterfactual_policy import CounterfactualPolicy
from kurt2rt.runs.replay.run import Report, Run, progress_reporter
from kurt2rt.runs.replay.trial import RecentRuns, compatible_runs, newest_compatible_run

LAST_S: Final = 600.0
"""End of the newest run that is compared by default; the part before it is replayed only, in half the time."""

LONGEST_S: Final = 3600.0
"""Longest run that is replayed without being named: one hour takes half a minute."""

_Knowledge = tuple[tuple[TeachingEvent, ...], Statistics]


@dataclass(frozen=True, slots=True)
class TrialResult:
    """Decisions of one recorded run that an undo or redo would change."""

    run: str
    from_s: float
    """Start of the comparison since the first tick of the run."""
    found: Counterfactual


@dataclass(frozen=True)
class UndoPreview:
    """Decisions in recorded runs that an undo or redo would change, shown before it is done."""

    runs: tuple[TrialResult, ...]
    """Empty without a run to replay."""
    notes: tuple[str, ...]
    """Runs, or parts of one, that could not be replayed, with the reason."""


def preview(planned: UndoPlan, runs: Path, report: Report) -> UndoPreview:
    """Replay recorded runs with and without a planned undo or redo and return the differences; change nothing.

    Runs that do not fit the knowledge or fail in replay are left out, with a note. Raises KnowledgeError if there is
    no run or none fits.

    Args:
        planned: the undo or redo.
        runs: folder of runs, which are all replayed, or one run itself.
        report: progress callback; gets a run's name, the seconds replayed and the run's seconds.
    """
    return _try_on(planned, compatible_runs(runs, planned.binding), report, last_s=float("inf"))


def preview_on_newest(
    planned: UndoPlan, recordings: Path, report: Report, *, last_s: float = LAST_S, longest_s: float = LONGEST_S
) -> UndoPreview:
    """Replay the end of the newest recorded run of this knowledge, if there is one; change nothing.

    `last_s`: length in s of the compared end. The end of a run with a gap is the part before the gap; its notes say so.
    A run longer than `longest_s` is not replayed, which a note says.
    """
    newest = newest_compatible_run(recordings, planned.binding, planned.path)
    too_long = [run for run in newest.runs if run.duration_s > longest_s]
    if too_long:
        (run,) = too_long
        note = f"{run.name}: lasts {run.duration_s / 60:.0f} min, which takes long; name it with --runs to try it"
        return UndoPreview((), (*newest.left_out, note))
    return _try_on(planned, newest, report, last_s=last_s)


def _try_on(planned: UndoPlan, runs: RecentRuns, report: Report, last_s: float) -> UndoPreview:
    events, statistics = planned.events, planned.statistics
    dimensions = len(planned.binding.feature_names)
    before = events, statistics
    after = (*events, *planned.changes), statistics_after(events, planned.changes, statistics, dimensions)
    tried, troubles = list[TrialResult](), list[str]()
    for run in runs.runs:
        try:
            tried.append(_try_run(run, before, after, report, last_s))
        except RecordingError as error:
            troubles.append(str(error))
    return UndoPreview(tuple(tried), (*runs.notes, *troubles))


def _try_run(run: Run, before: _Knowledge, after: _Knowledge, report: Report, last_s: float) -> TrialResult:
    # What comes after a gap cannot be replayed: the end of such a run is where that begins.
    from_s = max(run.duration_without_gap_s - last_s, 0.0) if run.duration_s > last_s else 0.0
    old, new = (CounterfactualPolicy(run, *each) for each in (before, after))
    return TrialResult(run.name, from_s, counterfactual(run, new, old, progress_reporter(run, report), from_s))
