"""What an undo or a redo would change in recorded runs."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from kurt2rt.knowledge.versions.editing import statistics_after
from kurt2rt.knowledge.versions.undo import UndoPlan
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.replay.counterfactual import Counterfactual, counterfactual
from kurt2rt.runs.replay.counterfactual_policy import CounterfactualPolicy
from kurt2rt.runs.replay.run import Run
from kurt2rt.runs.replay.trial import (
    RecentRuns,
    Report,
    TrialKnowledge,
    compatible_runs,
    newest_compatible_run,
    progress_reporter,
)

LAST_S: Final = 600.0
"""So much of the newest run is compared where nobody named one: what came before is replayed, in half the time."""

LONGEST_S: Final = 3600.0
"""A longer run is not tried unless it is named: to replay an hour takes half a minute."""


@dataclass(frozen=True, slots=True)
class TrialResult:
    """What a change would have changed in one run."""

    run: str
    from_s: float
    """Where the comparison began, since the first tick of the run."""
    found: Counterfactual


@dataclass(frozen=True)
class UndoPreview:
    """A change that was tried."""

    runs: tuple[TrialResult, ...]
    """Empty where there was none to try it on."""
    notes: tuple[str, ...]
    """Which runs, or parts of one, could not be tried, and why."""


def preview(planned: UndoPlan, runs: Path, report: Report) -> UndoPreview:
    """Try it on all recorded runs in a folder, or on the one that `runs` is; changes nothing.

    Raises KnowledgeError where none of them can be tried.
    """
    return _try_on(planned, compatible_runs(runs, planned.binding), report, last_s=float("inf"))


def preview_on_newest(
    planned: UndoPlan, recordings: Path, report: Report, *, last_s: float = LAST_S, longest_s: float = LONGEST_S
) -> UndoPreview:
    """Try it on the end of the newest recorded run of this knowledge, where there is one; changes nothing.

    The end of a run with a gap is the last before that: its notes say what comes after it was not tried.
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
    before = TrialKnowledge(events, statistics)
    after = TrialKnowledge(
        (*events, *planned.changes), statistics_after(events, planned.changes, statistics, dimensions)
    )
    tried, troubles = list[TrialResult](), list[str]()
    for run in runs.runs:
        try:
            tried.append(_try_run(run, before, after, report, last_s))
        except RecordingError as error:
            troubles.append(str(error))
    return UndoPreview(tuple(tried), (*runs.notes, *troubles))


def _try_run(run: Run, before: TrialKnowledge, after: TrialKnowledge, report: Report, last_s: float) -> TrialResult:
    # What comes after a gap cannot be replayed: the end of such a run is where that begins.
    from_s = max(run.duration_without_gap_s - last_s, 0.0) if run.duration_s > last_s else 0.0
    old, new = (CounterfactualPolicy(run, each.events, each.statistics) for each in (before, after))
    return TrialResult(run.name, from_s, counterfactual(run, new, old, progress_reporter(run, report), from_s))
