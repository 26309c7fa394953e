"""Check: the best trials once, paired with the shipped settings; file of the found settings."""

import json
from pathlib import Path

import pytest
import yaml

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.search.settings import Objective
from kurt2rt.experiments.search.tables import write_found
from kurt2rt.experiments.search.trials import (
    CheckedSettings,
    CheckRecord,
    CheckResult,
    SearchTrials,
    _begin_check,
    compare,
    require_unchecked,
)
from kurt2rt.experiments.study.intervals import Rate
from kurt2rt.experiments.study.jobs import ExaminedOutcome, StudyError
from tests.experiments.search.test_score import robot
from tests.experiments.search.tiny import tiny_plan

OBJECTIVE: Objective = "passed_then_presses"


def robots(*passed: int, presses: int = 10) -> tuple[ExaminedOutcome, ...]:
    return tuple(robot(each, presses, 4) for each in passed)


def compared(*passed: int, presses: int = 10, comparisons: int = 1, shipped: tuple[int, ...]) -> CheckedSettings:
    return compare("0001", {}, robots(*passed, presses=presses), robots(*shipped), OBJECTIVE, comparisons)


def test_more_exams_passed_by_the_whole_interval_are_better() -> None:
    better = compared(*[4] * 20, shipped=(3,) * 20)
    assert better.passed == pytest.approx((0.25, 0.25, 0.25))
    assert better.is_better
    assert not compared(4, *[3] * 19, shipped=(3,) * 20).is_better
    assert not compared(*[2] * 20, presses=1, shipped=(3,) * 20).is_better


def test_equal_exams_with_fewer_presses_are_better() -> None:
    assert compared(*[3] * 20, presses=5, shipped=(3,) * 20).is_better
    assert not compared(*[3] * 20, presses=10, shipped=(3,) * 20).is_better
    assert not compared(*[3] * 20, presses=15, shipped=(3,) * 20).is_better
    assert not compared(2, 4, *[3] * 18, presses=5, shipped=(3,) * 20).is_better


def test_check_is_made_once(tmp_path: Path) -> None:
    plan = tiny_plan(tmp_path)
    with plan.parts["results"].held():
        trials = SearchTrials(plan)
        for number, score in enumerate((0.9, 0.5, 0.7)):
            trials.begin(number)
            trials.study.tell(number, score)
        record = _begin_check(plan, trials, 3)
        assert (record.trials, record.candidates) == (3, (2,))
        trials.begin(3)
        trials.study.tell(3, 1.0)
        assert _begin_check(plan, trials, 3) == record
    assert require_unchecked(plan, 3) == record
    with pytest.raises(StudyError, match=r"checked after 3 trials \(got --trials 4, allowed 3\)"):
        require_unchecked(plan, 4)


def test_damaged_record_of_a_check_is_refused(tmp_path: Path) -> None:
    plan = tiny_plan(tmp_path)
    plan.folder.mkdir()
    (plan.folder / "check.json").write_text("{}")
    with pytest.raises(StudyError, match="is not the record of a check"):
        require_unchecked(plan, 3)


VALUES = {"learning.radius": 512.0, "learning.weights.0.weight": 0.7}
RECORD = CheckRecord(trials=9, candidates=(7,), date="2026-11-27T04:00:00+00:00")


def written(folder: Path, passed: Rate) -> dict[str, object]:
    """Write what a check with this difference found; return the content of the file."""
    robots = (robot(4, 9, 4), robot(3, 11, 4))
    checked = CheckedSettings("0007", VALUES, robots, passed, Rate(-2.0, -3.0, -1.0))
    check = CheckResult(RECORD, robots, (checked,), "passed_then_presses")
    write_found(tiny_plan(folder), check, "kurt2rt study search tiny", folder / "found.yaml")
    content: dict[str, object] = yaml.safe_load((folder / "found.yaml").read_text())
    return content


def test_found_changes_are_taken_by_set(tmp_path: Path) -> None:
    found = written(tmp_path, Rate(0.25, 0.125, 0.375))
    changes = found["changes"]
    assert isinstance(changes, dict)
    task = load_task("wall_following", changes={key: json.dumps(value) for key, value in changes.items()})
    assert task.learning.radius == 512.0
    assert task.learning.weights[0].weight == 0.7
    assert "Trial 0007 is better" in str(found["verdict"])
    assert "+25.0 (+12.5 to +37.5) percentage points, presses -2.0 (-3.0 to -1.0)" in str(found["verdict"])
