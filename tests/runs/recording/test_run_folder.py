"""Runs are in the order of recording, whatever the wall clock said."""

import re
from datetime import UTC, datetime
from pathlib import Path

import pytest

from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.run_folder import (
    find_run,
    make_room,
    next_run_name,
    run_name,
    runs_in,
    segment_name,
    used_bytes,
)
from tests.runs.recording.desk_recording import RecordedDesk


def recorded(recordings: Path, name: str) -> Path:
    """Record a run of one tick; return its folder."""
    desk = RecordedDesk(recordings, name=name)
    desk.run(1)
    desk.recorder.close()
    return recordings / name


def filled(folder: Path, size: int = 1000) -> Path:
    """Make a run folder with one file of `size` bytes; return it."""
    folder.mkdir(parents=True)
    (folder / segment_name(1)).write_bytes(bytes(size))
    return folder


def test_a_run_is_named_by_its_start_and_task(tmp_path: Path) -> None:
    name = run_name(datetime(2026, 11, 22, 3, 10, 5, tzinfo=UTC), "wall_following")
    assert name == "20261122T031005Z-wall_following"
    assert next_run_name(name, tmp_path / "none yet") == name
    recorded(tmp_path, "20261122T031004Z-wall_following")
    assert next_run_name(name, tmp_path) == name
    recorded(tmp_path, name)
    assert next_run_name(name, tmp_path) == name  # a number is put behind it


def test_run_started_by_a_clock_set_back_is_still_the_newest(tmp_path: Path) -> None:
    recorded(tmp_path, "20261122T235959Z-wall_following-2")
    name = next_run_name("20261122T221005Z-streets", tmp_path)
    assert name == "20261123T000000Z-streets"
    assert find_run(None, tmp_path) != (newest := recorded(tmp_path, name))
    assert find_run(None, tmp_path) == newest


@pytest.mark.parametrize("odd", ["20269999T000000Z-mine", "99991231T235959Z-mine"])
def test_a_folder_that_is_no_time_is_passed_over(tmp_path: Path, odd: str) -> None:
    recorded(tmp_path, odd)
    assert next_run_name("20261122T221005Z-streets", tmp_path) == "20261122T221005Z-streets"


def test_a_run_without_a_tick_is_not_the_newest(tmp_path: Path) -> None:
    filled(tmp_path / "older" / "20261122T031007Z-wall_following")
    with pytest.raises(RecordingError, match=re.escape(str(tmp_path / "older"))):
        find_run(None, tmp_path / "older")
    run = recorded(tmp_path, "20261122T031005Z-wall_following")
    filled(tmp_path / "20261122T031007Z-wall_following")
    assert find_run(None, tmp_path) == run


def test_room_is_made_here_and_not_where_a_link_leads(tmp_path: Path) -> None:
    kept = filled(tmp_path / "archive" / "20240101T000000Z-walls")
    runs = tmp_path / "runs"
    oldest, newest = filled(runs / "20250101T000000Z-walls"), filled(runs / "20260101T000000Z-walls")
    (runs / "20240101T000000Z-walls").symlink_to(kept)
    assert used_bytes(runs) == 2000
    assert make_room(runs, None, 1500) == 1000
    assert not oldest.exists()
    assert (kept / segment_name(1)).is_file()
    assert runs_in(runs) == [runs / "20240101T000000Z-walls", newest]
