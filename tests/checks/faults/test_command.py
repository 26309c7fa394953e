"""`kurt2rt faults`, as it is typed."""

import json
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from config import CONFIG_DIR
from hal.settings import content_of
from kurt2rt.checks.faults.scenario import DidNotDriveError
from kurt2rt.cli.faults import faults


@pytest.fixture
def app() -> typer.Typer:
    app = typer.Typer()
    app.command()(faults)
    return app


def run(app: typer.Typer, *arguments: str) -> tuple[int, str]:
    result = CliRunner(env={"COLUMNS": "120"}).invoke(app, arguments)
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result.exit_code, result.output


def changed_table(tmp_path: Path, **update: object) -> str:
    content = content_of(CONFIG_DIR / "faults" / "kurt2.yaml")
    content["cases"]["tick"]["stuck"].update(update)
    path = tmp_path / "mine.yaml"
    path.write_text(json.dumps(content))
    return str(path)


def test_some_cases_print_their_matrix_and_write_json(app: typer.Typer, tmp_path: Path) -> None:
    file = tmp_path / "faults.json"
    arguments = ("--target", "tick", "--kind", "stuck", "--kind", "wrong", "--seeds", "2", "--json", str(file))
    exit_code, said = run(app, *arguments)
    assert exit_code == 0, said
    assert "2 cases, 4 trials, 0 not as they must be" in said
    assert "tick hung" in said
    for word in ("stands: until the fault is over", "asks: stands because", "stutters: stands", "drives: never stands"):
        assert word in said
    report = json.loads(file.read_text(encoding="utf-8"))
    (hung,) = report["stop_times"]
    assert hung["trials"] == 2
    assert 0.1 <= hung["median_s"] <= hung["worst_s"] <= 0.11
    assert [(row["kind"], row["seed"], row["passed"]) for row in report["trials"]] == [
        ("stuck", 1, True),
        ("stuck", 2, True),
        ("wrong", 1, True),
        ("wrong", 2, True),
    ]
    assert report["trials"][0]["last"]["because"] == ["ticks ceased"]


def test_faults_deviation_exits_with_code_1(app: typer.Typer, tmp_path: Path) -> None:
    table = changed_table(tmp_path, within_s=0.05)
    exit_code, said = run(app, "--target", "tick", "--kind", "stuck", "--table", table)
    assert exit_code == 1
    assert "tick stuck, seed 1: must stand within 50 ms, took 10" in said
    assert "NOT SO" in said


def test_a_known_gap_is_said(app: typer.Typer, tmp_path: Path) -> None:
    table = changed_table(tmp_path, because="bus lost", known_gap="cause unknown")
    exit_code, said = run(app, "--target", "tick", "--kind", "stuck", "--table", table)
    assert exit_code == 0
    assert "tick stuck: known gap: cause unknown" in said
    assert "1 known gaps" in said


@pytest.mark.parametrize(("option", "name"), [("--target", "wings"), ("--kind", "tired")])
def test_faults_unknown_target_lists_the_known_ones(app: typer.Typer, option: str, name: str) -> None:
    exit_code, said = run(app, option, name)
    assert exit_code == 2
    assert f"there is no {name}; give some of" in said


def test_a_robot_that_stands_anyway_shows_nothing(app: typer.Typer, tmp_path: Path) -> None:
    content = content_of(CONFIG_DIR / "faults" / "kurt2.yaml")
    path = tmp_path / "standing.yaml"
    path.write_text(json.dumps({**content, "action": "stand"}))
    with pytest.raises(DidNotDriveError, match="tick stuck: the robot stands before anything fails"):
        run(app, "--target", "tick", "--kind", "stuck", "--table", str(path))
