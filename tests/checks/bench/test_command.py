"""`kurt2rt bench`, as it is typed."""

import json
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from kurt2rt.cli.bench import bench


@pytest.fixture
def app() -> typer.Typer:
    app = typer.Typer()
    app.command()(bench)
    return app


@pytest.mark.deep
def test_one_benchmark_prints_its_table_and_writes_json(app: typer.Typer, tmp_path: Path) -> None:
    file = tmp_path / "results.json"
    arguments = ["--only", "match", "--quick", "--json", str(file), "--folder", str(tmp_path)]
    result = CliRunner(env={"COLUMNS": "120"}).invoke(app, arguments)
    assert result.exit_code == 0, result.output
    assert "nearest of 100000 RLAs" in result.stdout
    assert "load average" in result.stdout
    report = json.loads(file.read_text(encoding="utf-8"))
    assert [row["what"] for row in report["results"]] == [f"nearest of {n} RLAs" for n in (135, 1000, 100000)]
    assert all(row["reference"]["ratio"] > 0 for row in report["results"])
    assert list(tmp_path.iterdir()) == [file]


def test_bench_unknown_name_is_refused_with_the_known_ones(app: typer.Typer) -> None:
    result = CliRunner(env={"COLUMNS": "200"}).invoke(app, ["--only", "match,speed"])
    assert result.exit_code == 2
    assert "there is no speed; give some of lateness, tick, match, loop, lesson, channel" in result.output


def test_bench_unwritable_report_is_refused_before_the_work(app: typer.Typer, tmp_path: Path) -> None:
    result = CliRunner(env={"COLUMNS": "200"}).invoke(app, ["--json", str(tmp_path / "not there" / "results.json")])
    assert result.exit_code == 2
    assert "make it first" in result.output


def test_help_says_what_is_measured_and_what_the_exit_code_means(app: typer.Typer) -> None:
    result = CliRunner(env={"COLUMNS": "200"}).invoke(app, ["--help"])
    assert "lateness, tick, match, loop, lesson, channel" in result.stdout
    assert "ends with code 0" in " ".join(result.stdout.split())
