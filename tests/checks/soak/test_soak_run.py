"""A soak in which everything fails: its checks hold."""

from pathlib import Path

import pytest

from kurt2rt.checks.soak.result import SoakResult
from kurt2rt.knowledge.journal.loading import read_lessons
from tests.checks.soak.helpers import DAY, ROBOT, TASK, busy_day, soaked


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("soak")


@pytest.fixture(scope="module")
def result(folder: Path) -> SoakResult:
    """Return the result of a minute."""
    return soaked(folder, 1.0, busy_day(lives_s=(18.0, 24.0), fault_gap_s=0.8))


def test_soak_run_holds_under_all_faults(result: SoakResult) -> None:
    assert [check for check in result.checks if not check.passed] == []
    assert result.passed
    assert result.complaints == ()


def test_it_was_worth_looking_at(result: SoakResult) -> None:
    assert len(result.starts) >= 3
    assert len({(each.target, each.kind) for each in result.faults}) == len(result.faults) >= 8
    assert any(each.drove for each in result.faults)
    assert any(each.stood_after_s is not None for each in result.faults if each.drove)
    assert max(minute.drives for minute in result.minutes) > 0.3
    assert result.minutes[-1].rlas > 5


def test_every_lesson_of_every_start_is_in_the_file(result: SoakResult, folder: Path) -> None:
    assert len(read_lessons(folder / "soak.knowledge", ROBOT, TASK)) >= result.minutes[-1].lessons > 10


def test_every_start_left_a_recording_of_its_own(result: SoakResult, folder: Path) -> None:
    runs = sorted(path.name for path in (folder / "runs").iterdir())
    assert len(runs) == len(result.starts)
    assert runs[0].startswith("20000101T000000Z")


@pytest.mark.deep
def test_the_same_seed_is_the_same_day(tmp_path: Path) -> None:
    days = []
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        days.append(soaked(tmp_path / name, 0.4, busy_day(lives_s=(8.0, 12.0), fault_gap_s=1.0), seed=4))
    one, other = days
    assert (one.ticks, one.missed_ticks, one.frames) == (other.ticks, other.missed_ticks, other.frames)
    assert (one.faults, one.counted) == (other.faults, other.counted)
    assert [each._replace(left_mb=0.0) for each in one.starts] == [each._replace(left_mb=0.0) for each in other.starts]
    assert len(one.faults) > 1


@pytest.mark.deep
@pytest.mark.parametrize("seed", [2, 3])
def test_an_hour_and_a_quarter_of_the_shipped_day(tmp_path: Path, seed: int) -> None:
    """Also as much of it as memory is looked at in."""
    result = soaked(tmp_path, 75.0, DAY, seed)
    assert [check for check in result.checks if not check.passed] == []


@pytest.mark.deep
def test_every_case_at_some_time(tmp_path: Path) -> None:
    """Each of the 84, while the robot does something else each time."""
    result = soaked(tmp_path, 40.0, busy_day(fault_gap_s=4.0, lives_s=(60.0, 300.0)), seed=5)
    assert [check for check in result.checks if not check.passed] == []
    assert len({(each.target, each.kind) for each in result.faults}) == 84
