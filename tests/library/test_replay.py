"""A simulated robot's run is recorded, and decided again bit for bit."""

from dataclasses import replace
from pathlib import Path

import pytest

import kurt2rt
from kurt2rt.runs.explain.timeline import Kind
from kurt2rt.runs.replay.comparison import TickDifference


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with one run: a question, a lesson, a drive up to the next question, and another lesson."""
    folder = tmp_path_factory.mktemp("recordings")
    with kurt2rt.SimulatedRobot(world="a", seed=1, record=folder) as robot:
        robot.teach("forward")
        robot.run(3)
        assert robot.question
        robot.teach("spin_right")
        robot.step(60)
        assert robot.recording is not None
        assert robot.recording.parent == folder
    return folder


@pytest.fixture(scope="module")
def replayed(recordings: Path) -> kurt2rt.ReplayedRun:
    return kurt2rt.replay(recordings)


def test_replay_of_a_recorded_robot_is_exact(replayed: kurt2rt.ReplayedRun) -> None:
    assert replayed.exact
    assert replayed.ticks == 1 + 1 + 300 + 1 + 60
    assert replayed.difference is None
    told = [(stretch.kind, stretch.what) for stretch in replayed.decisions]
    assert told[:4] == [(Kind.ASKS, "asks"), (Kind.DRIVES, "forward"), (Kind.ASKS, "asks"), (Kind.DRIVES, "spin_right")]
    assert "363 ticks were decided again bit for bit" in repr(replayed)


def test_replay_explains_each_second(replayed: kurt2rt.ReplayedRun) -> None:
    assert replayed.why(at=0.0).endswith("situation\nNothing was taught yet.")
    assert replayed.why(at=1.0).startswith("forward\nThis is like RLA 1, which says forward")
    with pytest.raises(kurt2rt.Error, match=r"at: outside of the run \(got 9\.0, allowed 0 to 3\.63 s\)"):
        replayed.why(at=9.0)


def test_replay_with_a_difference_is_not_exact(replayed: kurt2rt.ReplayedRun) -> None:
    difference = TickDifference(7, "decision.action", "forward", "stand")
    other = replace(replayed, verdict=replace(replayed.verdict, differences=(difference,)))
    assert not other.exact
    assert other.difference == "tick 7: decision.action was 'forward', and is 'stand' now"
    assert other.difference in repr(other)


@pytest.mark.parametrize("there", [False, True])
def test_replay_of_what_is_no_run_is_refused(there: bool, tmp_path: Path) -> None:
    path = tmp_path if there else tmp_path / "missing"
    with pytest.raises(kurt2rt.Error, match=path.name):
        kurt2rt.replay(path)


def test_record_into_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(kurt2rt.Error, match=r"file: recording: nothing is recorded"):
        kurt2rt.SimulatedRobot(record=tmp_path / "file")
