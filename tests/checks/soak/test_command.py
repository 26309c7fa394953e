"""`kurt2rt soak`, as it is typed."""

import json
import signal
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from kurt2rt.checks.soak.soak_run import SoakRun
from kurt2rt.cli.soak import soak


def test_soak_leaves_report_picture_and_recordings(tmp_path: Path) -> None:
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


def test_ctrl_c_ends_it_with_a_report_of_what_was_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    app = typer.Typer()
    app.command()(soak)
    before = signal.getsignal(signal.SIGINT)
    seen = SoakRun._on_tick
    ticks = 0

    def interrupted(*words: object) -> None:
        nonlocal ticks
        ticks += 1
        if ticks == 100:
            signal.raise_signal(signal.SIGINT)
        seen(*words)  # type: ignore[arg-type]

    monkeypatch.setattr(SoakRun, "_on_tick", interrupted)
    monkeypatch.setattr("kurt2rt.checks.soak.picture.draw_soak", lambda *_: None)  # the soak above is drawn
    result = CliRunner(env={"COLUMNS": "120"}).invoke(app, ["--hours", "24", "--out", str(tmp_path)])
    assert result.exception is None, result.output
    assert 100 <= json.loads((tmp_path / "soak.json").read_text())["ticks"] < 3000
    assert signal.getsignal(signal.SIGINT) is before
