"""Runs are in the order of recording, whatever the wall clock said."""

from datetime import UTC, datetime
from pathlib import Path

import pytest

from kurt2rt.recording.run_folder import find_run, later_name, run_name, segment_name


def recorded(recordings: Path, name: str) -> Path:
    folder = recordings / name
    folder.mkdir(parents=True)
    (folder / segment_name(1)).touch()
    return folder


def test_a_run_is_named_by_its_start_and_task(tmp_path: Path) -> None:
    name = run_name(datetime(2026, 11, 22, 3, 10, 5, tzinfo=UTC), "wall_following")
    assert name == "20261122T031005Z-wall_following"
    assert later_name(name, tmp_path / "none yet") == name
    recorded(tmp_path, "20261122T031004Z-wall_following")
    assert later_name(name, tmp_path) == name
    recorded(tmp_path, name)
    assert later_name(name, tmp_path) == name  # a number is put behind it


def test_a_run_that_was_started_by_a_clock_set_back_is_the_newest_all_the_same(tmp_path: Path) -> None:
    recorded(tmp_path, "20261122T235959Z-wall_following-2")
    name = later_name("20261122T221005Z-streets", tmp_path)
    assert name == "20261123T000000Z-streets"
    assert find_run(None, tmp_path) != (newest := recorded(tmp_path, name))
    assert find_run(None, tmp_path) == newest


@pytest.mark.parametrize("odd", ["20269999T000000Z-mine", "99991231T235959Z-mine"])
def test_a_folder_that_is_no_time_is_passed_over(tmp_path: Path, odd: str) -> None:
    recorded(tmp_path, odd)
    assert later_name("20261122T221005Z-streets", tmp_path) == "20261122T221005Z-streets"
