"""Recorded runs that knowledge can be tried on."""

from dataclasses import dataclass
from pathlib import Path

from config.settings import SettingsError
from kurt2rt.knowledge.journal.binding import KnowledgeBinding, require_compatible
from kurt2rt.knowledge.journal.loading import binding_for
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.run_folder import runs_in, segments_in
from kurt2rt.runs.replay.counterfactual_policy import PolicyAnswer
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.run import Run

_NEWEST = 20
"""Most recent runs that are searched for a compatible one."""


@dataclass(frozen=True)
class RecentRuns:
    """Recorded runs on which knowledge can be tried, because it fits their robot and task."""

    runs: tuple[Run, ...]
    left_out: tuple[str, ...]
    """Reasons why other runs are left out, a sentence each."""

    @property
    def notes(self) -> tuple[str, ...]:
        """Lines on runs that were not replayed, with reasons; a gap is known after the replay."""
        gaps = (f"{run.name}: {run.trouble}" for run in self.runs if not run.has_no_gap)
        return (*self.left_out, *gaps)


def compatible_runs(folder: Path, binding: KnowledgeBinding) -> RecentRuns:
    """Return the runs of `folder`, or the run `folder` itself, that this knowledge fits.

    Raises KnowledgeError if there is none.
    """
    paths = _recorded_in(folder) or [folder]
    if not folder.exists() or (folder.is_dir() and paths == [folder] and not segments_in(folder)):
        raise KnowledgeError(KnowledgeCode.NO_RECORDED_RUN, where=folder)
    runs, left_out = list[Run](), list[str]()
    for path in paths:
        try:
            run = read_run(path)
            reason = _incompatibility(run, binding)
        except RecordingError as error:
            reason = str(error)
        if reason is None:
            runs.append(run)
        else:
            left_out.append(reason)
    if not runs:
        raise KnowledgeError(KnowledgeCode.NO_RUN_FITS, where=folder, reason=left_out[0])
    return RecentRuns(tuple(runs), tuple(left_out))


def newest_compatible_run(recordings: Path, binding: KnowledgeBinding, knowledge: Path) -> RecentRuns:
    """Return the newest recent run that taught into the file `knowledge`, else the newest compatible one.

    Empty without one. Its notes name newer runs that cannot be read. Only one run is kept in memory.
    """
    newest, left_out = None, list[str]()
    for path in _recorded_in(recordings)[: -_NEWEST - 1 : -1]:
        try:
            run = read_run(path)
            if _incompatibility(run, binding) is not None or next(run.entries(), None) is None:
                continue
        except RecordingError as error:
            if newest is None:
                left_out.append(str(error))
            continue
        if _taught_into(run, knowledge):
            return RecentRuns((run,), tuple(left_out))
        newest = newest or run
    return RecentRuns(() if newest is None else (newest,), tuple(left_out))


def format_answer(answer: PolicyAnswer) -> str:
    """Return the answer of one level in a few words."""
    return "asks" if answer.rla is None else f"{answer.rla.action} by {answer.rla.title}"


def _recorded_in(folder: Path) -> list[Path]:
    return [each for each in runs_in(folder) if segments_in(each)]


def _taught_into(run: Run, knowledge: Path) -> bool:
    """Return whether a run taught into that file."""
    return bool(run.head.knowledge) and Path(run.head.knowledge).resolve() == knowledge.resolve()


def _incompatibility(run: Run, binding: KnowledgeBinding) -> str | None:
    """Return why this knowledge does not fit a run, or None. Raises RecordingError for unusable settings."""
    try:
        with run.settings():
            require_compatible(binding, binding_for(run.robot, run.task), Path(run.name), lambda _: False)
    except KnowledgeError as error:
        return str(error)
    except SettingsError as error:
        raise RecordingError(f"its settings cannot be used by this kurt2rt: {error}", where=run.name) from error
    return None
