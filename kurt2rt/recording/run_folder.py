"""Folders of recorded runs: what they are called, which is the newest, and which go when there is no more room."""

import re
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

from kurt2rt.recording.error import RecordingError

SEGMENT_ENDING = ".mcap"
_RUN_NAME = re.compile(r"\d{8}T\d{6}Z-.+")
_SEGMENT_NAME = re.compile(r"\d{4,}\.mcap")


def run_name(started: datetime, task: str) -> str:
    """Name of a run's folder: runs of one folder are in the order of their names. `started`: with its time zone."""
    return f"{started.astimezone(UTC):%Y%m%dT%H%M%SZ}-{task}"


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
    return sorted((each for each in run.iterdir() if _SEGMENT_NAME.fullmatch(each.name)), key=_number_of)


def find_run(given: Path | None, recordings: Path) -> Path:
    """The run folder or segment that a command line means: `given`, by path or by its name in `recordings`.

    None: the newest run of `recordings`. Raises RecordingError in a sentence.
    """
    if given is None:
        runs = runs_in(recordings)
        if not runs:
            raise RecordingError(f"{recordings}: no recorded run is there; kurt2rt run makes one, or give its folder")
        return runs[-1]
    for path in (given, recordings / given):
        if path.is_file() or (path.is_dir() and segments_in(path)):
            return path
    raise RecordingError(f"{given}: no recorded run; give a folder of {recordings}, or a file {segment_name(1)} in one")


def make_room(recordings: Path, current: Path | None, budget_bytes: int) -> list[Path]:
    """Delete the oldest runs, then the oldest segments of `current`, until all together fit in the budget.

    The newest segment of `current` stays, whatever it takes. Returns what was deleted. Raises OSError.
    """
    files = list(_oldest_first(recordings, current))
    sizes = [(path, path.stat().st_size) for path in files]
    too_much = sum(size for _, size in sizes) - budget_bytes
    newest = files[-1] if files and current is not None and files[-1].parent == current else None
    deleted = []
    for path, size in sizes:
        if too_much <= 0 or path == newest:
            break
        path.unlink()
        deleted.append(path)
        too_much -= size
        if path.parent != current:
            _remove_if_empty(path.parent)
    return deleted


def _oldest_first(recordings: Path, current: Path | None) -> Iterator[Path]:
    for run in runs_in(recordings):
        if run != current:
            yield from segments_in(run)
    if current is not None and current.is_dir():
        yield from segments_in(current)


def _remove_if_empty(run: Path) -> None:
    if not any(run.iterdir()):
        run.rmdir()


def _number_of(segment: Path) -> int:
    return int(segment.stem)
