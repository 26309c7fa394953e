"""File of the found settings."""

import json
from pathlib import Path

import yaml

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.search.check import CheckedSettings, CheckRecord, CheckResult
from kurt2rt.experiments.search.found import write_found
from kurt2rt.experiments.search.score import RobotScore
from kurt2rt.experiments.study.intervals import RateDifference
from kurt2rt.experiments.study.provenance import source_hash
from tests.experiments.search.tiny import tiny_plan

VALUES = {"learning.radius": 512.0, "learning.weights.0.weight": 0.7}
RECORD = CheckRecord(trials=9, candidates=(7,), date="2026-11-27T04:00:00+00:00")


def written(folder: Path, passed: RateDifference) -> dict[str, object]:
    """Write what a check with this difference found; return the content of the file."""
    robots = (RobotScore(4, 4, 9, 0, 50), RobotScore(3, 4, 11, 0, 60))
    checked = CheckedSettings("0007", VALUES, robots, passed, RateDifference(-2.0, -3.0, -1.0))
    check = CheckResult(RECORD, robots, (checked,), "passed_then_presses")
    write_found(tiny_plan(folder), check, "kurt2rt study search tiny", folder / "found.yaml")
    content: dict[str, object] = yaml.safe_load((folder / "found.yaml").read_text())
    return content


def test_found_changes_are_taken_by_set(tmp_path: Path) -> None:
    found = written(tmp_path, RateDifference(0.25, 0.125, 0.375))
    changes = found["changes"]
    assert isinstance(changes, dict)
    task = load_task("wall_following", changes={key: json.dumps(value) for key, value in changes.items()})
    assert task.learning.radius == 512.0
    assert task.learning.weights[0].weight == 0.7
    assert "Trial 0007 is better" in str(found["verdict"])
    assert "+25.0 (+12.5 to +37.5) percentage points, presses -2.0 (-3.0 to -1.0)" in str(found["verdict"])


def test_found_without_better_settings_changes_nothing(tmp_path: Path) -> None:
    found = written(tmp_path, RateDifference(0.25, -0.125, 0.375))
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
