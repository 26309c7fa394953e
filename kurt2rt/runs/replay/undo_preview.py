"""What an undo or a redo would change in recorded runs."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from kurt2rt.knowledge.exchange.json_checks import RecordingError
from kurt2rt.knowledge.versions.editing import worths_after
from kurt2rt.knowledge.versions.undo import Planned
from kurt2rt.runs.replay.counterfactual import Counterfactual, counterfactual
from kurt2rt.runs.replay.counterfactual_policy import Shadow
from kurt2rt.runs.replay.run import Run
from kurt2rt.runs.replay.trial import Known, Report, Runs, newest_to_try, runs_to_try, telling

LAST_S: Final = 600.0
"""So much of the newest run is compared where nobody named one: what came before is replayed, in half the time."""

LONGEST_S: Final = 3600.0
"""A longer run is not tried unless it is named: to replay an hour takes half a minute."""


@dataclass(frozen=True, slots=True)
class Tried:
    """What a change would have changed in one run."""

    run: str
    from_s: float
    """Where the comparison began, since the first tick of the run."""
    found: Counterfactual


@dataclass(frozen=True)
class Preview:
    """A change that was tried."""

    runs: tuple[Tried, ...]
    """Empty where there was none to try it on."""
    notes: tuple[str, ...]
    """Which runs, or parts of one, could not be tried, and why."""


def preview(planned: Planned, runs: Path, report: Report) -> Preview:
    """Try it on all recorded runs in a folder, or on the one that `runs` is; changes nothing.

    Raises KnowledgeError where none of them can be tried.
    """
    return _try_on(planned, runs_to_try(runs, planned.binding), report, last_s=float("inf"))


def preview_on_newest(
    planned: Planned, recordings: Path, report: Report, *, last_s: float = LAST_S, longest_s: float = LONGEST_S
) -> Preview:
    """Try it on the end of the newest recorded run of this knowledge, where there is one; changes nothing.

    The end of a run with a gap is the last before that: its notes say what comes after it was not tried.
    """
    newest = newest_to_try(recordings, planned.binding, planned.path)
    too_long = [run for run in newest.runs if run.lasts_s > longest_s]
    if too_long:
        (run,) = too_long
        note = f"{run.name}: lasts {run.lasts_s / 60:.0f} min, which takes long; name it with --runs to try it"
        return Preview((), (*newest.left_out, note))
    return _try_on(planned, newest, report, last_s=last_s)


def _try_on(planned: Planned, runs: Runs, report: Report, last_s: float) -> Preview:
    events, statistics = planned.events, planned.statistics
    dimensions = len(planned.binding.feature_names)
    before = Known(events, statistics)
    after = Known((*events, *planned.changes), worths_after(events, planned.changes, statistics, dimensions))
    tried, troubles = list[Tried](), list[str]()
    for run in runs.runs:
        try:
            tried.append(_tried(run, before, after, report, last_s))
        except RecordingError as error:
            troubles.append(str(error))
    return Preview(tuple(tried), (*runs.notes, *troubles))


def _tried(run: Run, before: Known, after: Known, report: Report, last_s: float) -> Tried:
    # What comes after a gap cannot be replayed: the end of such a run is where that begins.
    from_s = max(run.lasts_without_gap_s - last_s, 0.0) if run.lasts_s > last_s else 0.0
    old, new = (Shadow(run, each.events, each.statistics) for each in (before, after))
    return Tried(run.name, from_s, counterfactual(run, new, old, telling(run, report), from_s))
