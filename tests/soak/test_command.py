"""`kurt2rt soak`, as it is typed."""

import json
from pathlib import Path

import typer
from typer.testing import CliRunner

from kurt2rt.cli.soak import soak


def test_a_soak_of_some_seconds_leaves_report_picture_and_recordings(tmp_path: Path) -> None:
    app = typer.Typer()
    app.command()(soak)
    out = tmp_path / "soak"
    (out / "runs" / "old").mkdir(parents=True)
    result = CliRunner(env={"COLUMNS": "120"}).invoke(app, ["--hours", "0.002", "--out", str(out)])
    assert result.exception is None, result.output
    assert "the motion envelope holds" in result.output
    assert json.loads((out / "soak.json").read_text())["passed"] is True
    assert "what must hold" in (out / "soak.txt").read_text()
    assert (out / "soak.png").stat().st_size > 10_000
    assert [path.name for path in (out / "runs").iterdir()] == ["20000101T000000Z-wall_following"]
