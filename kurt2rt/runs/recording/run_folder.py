"""Folders of recorded runs: what they are called, which is the newest, and which go when there is no more room."""

import contextlib
import re
from datetime import UTC, datetime, timedelta
from pathlib import Path

from kurt2rt.runs.recording.disk import is_locked
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.segment_reader import TICK_TOPIC, SegmentReader

SEGMENT_ENDING = ".mcap"
_RUN_NAME = re.compile(r"\d{8}T\d{6}Z-.+")
_STAMP = "%Y%m%dT%H%M%SZ"
_STAMP_LETTERS = 16
_SEGMENT_NAME = re.compile(r"\d{4,}\.mcap")


def run_name(started: datetime, task: str) -> str:
    """Name of a run's folder: runs of one folder are in the order of their names. `started`: with its time zone."""
    return f"{started.astimezone(UTC):{_STAMP}}-{task}"


def next_run_name(name: str, recordings: Path) -> str:
    """The same name of a run's folder, or one a second after the newest run's, where the wall clock was set back.

    Runs stay in the order of recording: the newest is the one to replay, and the last to go. Raises OSError.
    """
    runs = runs_in(recordings)
    newest = runs[-1].name[:_STAMP_LETTERS] if runs else ""
    if newest <= name[:_STAMP_LETTERS]:
        return name
    try:
        later = datetime.strptime(newest, _STAMP).replace(tzinfo=UTC) + timedelta(seconds=1)
    except (ValueError, OverflowError):  # a folder that somebody else named
        return name
    return f"{later:{_STAMP}}{name[_STAMP_LETTERS:]}"


def segment_name(number: int) -> str:
    """Name of a run's n-th file, from 1."""
    return f"{number:04d}{SEGMENT_ENDING}"


def runs_in(folder: Path) -> list[Path]:
    """Run folders in a folder of recordings, the oldest first; none where there is no such folder. Raises OSError."""
    if not folder.is_dir():
        return []
    return sorted(each for each in folder.iterdir() if _RUN_NAME.fullmatch(each.name) and each.is_dir())


def segments_in(run: Path) -> list[Path]:
    """Files of a run, the oldest first. Raises OSError."""
    return sorted((each for each in run.iterdir() if _SEGMENT_NAME.fullmatch(each.name)), key=segment_number)


def segment_number(segment: Path) -> int:
    """The n of a run's n-th file."""
    return int(segment.stem)


def find_run(given: Path | None, recordings: Path) -> Path:
    """The run folder or segment that a command line means: `given`, by path or by its name in `recordings`.

    None: the newest run of `recordings` in which there was a tick. Raises RecordingError in a sentence.
    """
    if given is None:
        newest = next((each for each in reversed(runs_in(recordings)) if _has_ticks(each)), None)
        if newest is None:
            raise RecordingError(
                "no recorded run is there", where=recordings, do="kurt2rt run makes one, or give its folder"
            )
        return newest
    for path in (given, recordings / given):
        if path.is_file() or (path.is_dir() and segments_in(path)):
            return path
    raise RecordingError(
        "no recorded run", where=given, do=f"give a folder of {recordings}, or a file {segment_name(1)} in one"
    )


def _has_ticks(run: Path) -> bool:
    return any(True for segment in segments_in(run) for _ in SegmentReader(segment).messages({TICK_TOPIC}))


def used_bytes(recordings: Path) -> int:
    """That all runs take together; not what is elsewhere, and only has a link here. Raises OSError."""
    return sum(_size(segment) for run in _own_runs_in(recordings) for segment in segments_in(run))


def make_room(recordings: Path, current: Path | None, budget_bytes: int) -> int:
    """Delete the oldest runs, then the oldest segments of `current`, until all together fit in the budget.

    The newest segment of `current` stays, whatever it takes, and so do a run that another program records, what cannot
    be deleted, and what a link leads to. Folders of runs that hold nothing go. Returns the bytes that are left in use.
    Raises OSError.
    """
    used = used_bytes(recordings)
    others = [run for run in _own_runs_in(recordings) if run != current and not is_locked(run)]
    may_go = [segment for run in others for segment in segments_in(run)]
    if current is not None and current.is_dir():
        may_go += segments_in(current)[:-1]
    for segment in may_go:
        if used <= budget_bytes:
            break
        size = _size(segment)
        with contextlib.suppress(OSError):  # somebody else's: the next one goes in its place
            segment.unlink()
            used -= size
    for run in others:
        with contextlib.suppress(OSError):  # it holds something, if only a note that somebody put there
            run.rmdir()
    return used


def _own_runs_in(recordings: Path) -> list[Path]:
    return [run for run in runs_in(recordings) if not run.is_symlink()]


def _size(segment: Path) -> int:
    return segment.lstat().st_size
