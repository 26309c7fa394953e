"""`kurt2rt soak`, as it is typed."""

import json
import signal
from pathlib import Path

import pytest

from kurt2rt.checks.soak.check_text import property_text
from kurt2rt.checks.soak.result import CheckCode, SoakCheck
from kurt2rt.checks.soak.soak_run import SoakRun
from tests.cli.helpers import CommandLine


def test_soak_leaves_report_picture_and_recordings(kurt2rt: CommandLine, tmp_path: Path) -> None:
    out = tmp_path / "soak"
    (out / "runs" / "old").mkdir(parents=True)
    said = kurt2rt("soak", "--hours", "0.002", "--out", out)
    assert said.exit_code == 0, said.err
    assert json.loads((out / "soak.json").read_text())["passed"] is True
    assert property_text(SoakCheck(CheckCode.ENVELOPE, passed=True, values={})) in said.out
    assert CheckCode.ENVELOPE in (out / "soak.txt").read_text()
    assert (out / "soak.png").stat().st_size > 10_000
    assert [path.name for path in (out / "runs").iterdir()] == ["20000101T000000Z-wall_following"]


def test_ctrl_c_ends_it_with_a_report_of_what_was_seen(
    kurt2rt: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
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
    assert kurt2rt("soak", "--hours", "24", "--out", tmp_path).exit_code == 0
    assert 100 <= json.loads((tmp_path / "soak.json").read_text())["ticks"] < 3000
    assert signal.getsignal(signal.SIGINT) is before
