"""`kurt2rt doctor`, as it is typed."""

import json
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from kurt2rt.cli.doctor import doctor

SUBJECTS = {
    "Python",
    "timer",
    "clock",
    "real-time priority",
    "memory lock",
    "cores",
    "CPU governor",
    "BLAS threads",
    "SQLite",
    "knowledge folder",
    "free space",
    "fsync",
    "SQLite log",
    "CAN in the kernel",
    "virtual CAN",
    "pymunk",
    "matplotlib",
}


@pytest.fixture
def app() -> typer.Typer:
    app = typer.Typer()
    app.command()(doctor)
    return app


def test_doctor_prints_every_subject_and_a_last_line(app: typer.Typer, tmp_path: Path) -> None:
    result = CliRunner(env={"COLUMNS": "200"}).invoke(app, ["--folder", str(tmp_path), "--ticks", "3"])
    assert result.exit_code == 0, result.output
    for subject in SUBJECTS:
        assert subject in result.stdout
    assert result.stdout.splitlines()[-1].endswith("kurt2rt run can start")


def test_a_program_gets_json_and_code_1_when_there_is_no_disk(app: typer.Typer) -> None:
    result = CliRunner().invoke(app, ["--json", "--folder", "/proc/kurt2rt", "--ticks", "3"])
    assert result.exit_code == 1
    findings = {each["subject"]: each for each in json.loads(result.stdout)}
    assert [name for name, each in findings.items() if each["needed"] and each["status"] == "missing"] == [
        "knowledge folder"
    ]
    assert findings.keys() >= SUBJECTS - {"free space", "fsync", "SQLite log"}


def test_no_ticks_at_all_are_refused(app: typer.Typer) -> None:
    assert CliRunner().invoke(app, ["--ticks", "0"]).exit_code == 2


def test_help_says_what_the_exit_code_means(app: typer.Typer) -> None:
    result = CliRunner(env={"COLUMNS": "200"}).invoke(app, ["--help"])
    assert "Ends with code 1 only if something is missing" in result.stdout
