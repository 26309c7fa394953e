"""Recordings of `kurt2rt run`."""

from datetime import datetime
from pathlib import Path

import pytest

from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.recording.recording import LAYOUT
from kurt2rt.runs.recording.run_folder import runs_in, segments_in
from kurt2rt.runs.recording.segment_reader import SegmentReader
from kurt2rt.runs.recording.tick_json import decode_tick
from kurt2rt.runs.recording.topics import GROUND, SCENE, TICK, TRUTH
from kurt2rt.runs.replay.reader import read_run
from tests.cli.helpers import CommandLine

WORDS = ("run", "--seconds", "0.3", "--teacher", "none", "--knowledge", "mine.knowledge")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def entries_of(run: Path) -> list[TickEntry]:
    return [decode_tick(each.data) for segment in segments_in(run) for each in SegmentReader(segment).messages({TICK})]


def test_a_run_is_recorded_unless_told_otherwise(kurt2rt: CommandLine, folder: Path) -> None:
    said = kurt2rt(*WORDS)
    assert said.exit_code == 0
    (run,) = runs_in(folder / "var" / "runs")
    assert run.name.endswith("Z-wall_following")
    assert f" {run.relative_to(folder)}\n" in said.out
    numbers = [entry.number for entry in entries_of(run)]
    # How many of the 30 ticks there are is left to the machine: those of a stall are missed, not run.
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    assert read_run(run).head.knowledge == str(folder.resolve() / "mine.knowledge")  # wherever it is read
    (segment,) = segments_in(run)
    topics = {each.topic for each in SegmentReader(segment).messages()}
    assert {TICK, SCENE, TRUTH, GROUND} <= topics
    # Also of what a robot that knows nothing asks in its first tick.
    times = [each.time_ns for each in SegmentReader(segment).messages()]
    assert min(times) >= datetime.strptime(run.name[:16], "%Y%m%dT%H%M%S%z").timestamp() * 1e9


def test_a_live_view_needs_no_recording(kurt2rt: CommandLine, folder: Path) -> None:
    said = kurt2rt(*WORDS, "--no-record", "--live-view", "0")
    assert " ws://127.0.0.1:" in said.out
    assert f"import its layout once: {LAYOUT}\n" in said.out
    assert "recorded" not in said.out
    assert not (folder / "var").exists()


def test_a_folder_that_cannot_be_made_costs_no_tick_and_is_told(kurt2rt: CommandLine, folder: Path) -> None:
    (folder / "runs").write_text("a file", encoding="utf-8")
    said = kurt2rt(*WORDS, "--record", "runs")
    assert said.exit_code == 0
    assert "recording: " in said.out
