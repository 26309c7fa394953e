"""Check: the best trials once, paired with the shipped settings; file of the found settings."""

import json
from pathlib import Path

import pytest
import yaml
from optuna.trial import FrozenTrial, TrialState, create_trial

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.search.check import (
    CheckedSettings,
    CheckRecord,
    CheckResult,
    begin_check,
    best_trials,
    compare,
    read_record,
    require_unchecked,
)
from kurt2rt.experiments.search.score import RobotScore
from kurt2rt.experiments.search.settings import Objective
from kurt2rt.experiments.search.tables import write_found
from kurt2rt.experiments.search.trials import SearchTrials
from kurt2rt.experiments.study.intervals import Rate
from kurt2rt.experiments.study.provenance import source_hash
from kurt2rt.experiments.study.results import StudyError
from tests.experiments.search.tiny import tiny_plan

SHIPPED = {"r": 1.0}
OBJECTIVE: Objective = "passed_then_presses"


def trial(number: int, score: float | None, r: float = 2.0) -> FrozenTrial:
    from optuna.distributions import FloatDistribution

    state = TrialState.COMPLETE if score is not None else TrialState.PRUNED
    made = create_trial(state=state, value=score, params={"r": r}, distributions={"r": FloatDistribution(0.0, 9.0)})
    made.number = number
    return made


def robots(*passed: int, presses: int = 10) -> tuple[RobotScore, ...]:
    return tuple(RobotScore(each, 4, presses, 0, 50) for each in passed)


def compared(*passed: int, presses: int = 10, comparisons: int = 1, shipped: tuple[int, ...]) -> CheckedSettings:
    return compare("0001", {}, robots(*passed, presses=presses), robots(*shipped), OBJECTIVE, comparisons)


def test_best_trials_are_finished_and_not_the_shipped_settings() -> None:
    trials = [trial(0, 0.9, r=1.0), trial(1, None), trial(2, 0.5), trial(3, 0.8), trial(4, 0.8), trial(5, 0.1)]
    assert [each.number for each in best_trials(trials, 3, SHIPPED)] == [3, 4, 2]


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


def test_intervals_of_several_comparisons_are_wider() -> None:
    mixed = [4, 4, 4, 3, 3, 3, 3, 2, 3, 4]
    one, three = (compared(*mixed, shipped=(3,) * 10, comparisons=count).passed for count in (1, 3))
    assert one.value == three.value
    assert three.low < one.low
    assert three.high > one.high


def test_found_settings_are_the_best_of_the_better_ones() -> None:
    record, shipped = CheckRecord(trials=3, candidates=(1, 2), date="today"), robots(*[2] * 20)
    worse, better, best = (compared(*[n] * 20, shipped=(2,) * 20) for n in (1, 3, 4))
    assert CheckResult(record, shipped, (worse, better, best), OBJECTIVE).found is best
    assert CheckResult(record, shipped, (worse,), OBJECTIVE).found is None


def test_check_is_made_once(tmp_path: Path) -> None:
    plan = tiny_plan(tmp_path)
    with plan.parts["results"].held():
        trials = SearchTrials(plan)
        for number, score in enumerate((0.9, 0.5, 0.7)):
            trials.begin(number)
            trials.finish(number, score)
        record = begin_check(plan, trials, 3)
        assert (record.trials, record.candidates) == (3, (2,))
        trials.begin(3)
        trials.finish(3, 1.0)
        assert begin_check(plan, trials, 4) == record
    require_unchecked(plan, 3)
    with pytest.raises(StudyError, match=r"checked after 3 trials \(got --trials 4, allowed 3\)"):
        require_unchecked(plan, 4)


def test_damaged_record_of_a_check_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "check.json"
    path.write_text("{}")
    with pytest.raises(StudyError, match="is not the record of a check"):
        read_record(path)


VALUES = {"learning.radius": 512.0, "learning.weights.0.weight": 0.7}
RECORD = CheckRecord(trials=9, candidates=(7,), date="2026-11-27T04:00:00+00:00")


def written(folder: Path, passed: Rate) -> dict[str, object]:
    """Write what a check with this difference found; return the content of the file."""
    robots = (RobotScore(4, 4, 9, 0, 50), RobotScore(3, 4, 11, 0, 60))
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


def test_found_without_better_settings_changes_nothing(tmp_path: Path) -> None:
    found = written(tmp_path, Rate(0.25, -0.125, 0.375))
    assert found["changes"] == {}
    assert "the shipped settings stay" in str(found["verdict"])
    assert (found["command"], found["date"], found["source"]) == (
        "kurt2rt study search tiny",
        RECORD.date,
        source_hash(),
    )
    assert found["shipped"] == {
        "values": {"learning.radius": 900.0, "learning.weights.0.weight": 1.5},
        "passed": 7,
        "exams": 8,
        "effort": [9, 11],
    }
