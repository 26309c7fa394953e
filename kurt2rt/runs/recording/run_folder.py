"""Folders of recorded runs: names, order, disk space and deletion of the oldest."""

import contextlib
import re
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING

from kurt2rt.runs.recording.recording_disk import is_locked
from kurt2rt.runs.recording.recording_error import RecordingError

if TYPE_CHECKING:
    from kurt2rt.runs.recording.segment_reader import SegmentReader

MEGA = 1_000_000
SEGMENT_ENDING = ".mcap"
TICK_TOPIC = "/tick"
"""Topic of the ticks, of which a run is made."""
_RUN_NAME = re.compile(r"\d{8}T\d{6}Z-.+")
_STAMP = "%Y%m%dT%H%M%SZ"
_STAMP_LETTERS = 16
_SEGMENT_NAME = re.compile(r"\d{4,}\.mcap")


@dataclass(frozen=True, slots=True)
class Budget:
    """Limits of the disk space that recordings may take."""

    total_bytes: int
    """Limit of all runs together."""
    segment_bytes: int
    """Size at which the next segment is started."""
    reserve_bytes: int = 200 * MEGA
    """Free space kept for lessons: below it recordings are deleted, then suspended."""


def budget_of(megabytes: int) -> Budget:
    """Return a budget of `megabytes` for all runs."""
    return Budget(megabytes * MEGA, min(32 * MEGA, megabytes * MEGA // 10))


def run_name(started: datetime, task: str) -> str:
    """Return the folder name of a run, which sorts by time.

    `started`: with time zone. `task`: its name.
    """
    return f"{started.astimezone(UTC):{_STAMP}}-{task}"


def next_run_name(name: str, recordings: Path) -> str:
    """Return the name, or one a second after the newest run's if the wall clock was set back.

    Runs thus sort in the order of recording: the newest is replayed by default and deleted last. Raises OSError.
    """
    runs = runs_in(recordings)
    newest = runs[-1].name[:_STAMP_LETTERS] if runs else ""
    if newest <= name[:_STAMP_LETTERS]:
        return name
    try:
        later = datetime.strptime(newest, _STAMP).replace(tzinfo=UTC) + timedelta(seconds=1)
    except (ValueError, OverflowError):  # a folder with another name pattern
        return name
    return f"{later:{_STAMP}}{name[_STAMP_LETTERS:]}"


def segment_name(number: int) -> str:
    """Return the file name of a run's n-th segment, from 1."""
    return f"{number:04d}{SEGMENT_ENDING}"


def runs_in(folder: Path) -> list[Path]:
    """Return the run folders in a folder of recordings, oldest first; empty if it is missing. Raises OSError."""
    if not folder.is_dir():
        return []
    return sorted(each for each in folder.iterdir() if _RUN_NAME.fullmatch(each.name) and each.is_dir())


def segments_in(run: Path) -> list[Path]:
    """Return the segments of a run, oldest first. Raises OSError."""
    return sorted((each for each in run.iterdir() if _SEGMENT_NAME.fullmatch(each.name)), key=segment_number)


def segment_number(segment: Path) -> int:
    """Return the number in a segment's name, from 1."""
    return int(segment.stem)


def find_run(given: Path | None, recordings: Path) -> Path:
    """Return the run folder or segment named on a command line, by path or by name in `recordings`.

    None: the newest run of `recordings` with a tick. Raises RecordingError, and ModuleNotFoundError without the extra
    `recording`.
    """
    reader = segment_reader()
    if given is None:
        has_tick = (
            run
            for run in reversed(runs_in(recordings))
            if any(True for segment in segments_in(run) for _ in reader(segment).messages({TICK_TOPIC}))
        )
        newest = next(has_tick, None)
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


def segment_reader() -> "type[SegmentReader]":
    """Return the reader of segments. Raises ModuleNotFoundError without the extra `recording`."""
    # Late import: mcap is in the extra, and all else that reads runs is imported without it.
    from kurt2rt.runs.recording.segment_reader import SegmentReader

    return SegmentReader


def used_bytes(recordings: Path) -> int:
    """Return the size of all runs together, without targets of links. Raises OSError."""
    return sum(_size(segment) for run in _own_runs_in(recordings) for segment in segments_in(run))


def make_room(recordings: Path, current: Path | None, budget_bytes: int) -> int:
    """Delete the oldest runs, then the oldest segments of `current`, until all fit in the budget.

    The newest segment of `current` is kept, and so are runs locked by another program, files that cannot be deleted and
    targets of links. Empty run folders are removed. Returns the bytes still in use. Raises OSError.
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
        with contextlib.suppress(OSError):  # not ours to delete: the next one is tried
            segment.unlink()
            used -= size
    for run in others:
        with contextlib.suppress(OSError):  # not empty
            run.rmdir()
    return used


def _own_runs_in(recordings: Path) -> list[Path]:
    return [run for run in runs_in(recordings) if not run.is_symlink()]


def _size(segment: Path) -> int:
    return segment.lstat().st_size
