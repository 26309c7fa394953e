"""`kurt2rt export`, of the stored runs."""

import json
from pathlib import Path

from tests.cli.helpers import CommandLine
from tests.runs.replay.stored_runs import STORED


def test_command_exports_several_runs(kurt2rt: CommandLine, tmp_path: Path) -> None:
    walls, errand = STORED / "walls.mcap", STORED / "errand.mcap"
    said = kurt2rt("export", "lerobot", walls, errand, walls, "--out", tmp_path / "set", "--fps", "10", "--json")
    assert said.exit_code == 0, said.err
    told = json.loads(said.out)
    assert (told["folder"], told["fps"]) == (str(tmp_path / "set"), 10)
    assert [(each["episodes"], each["frames"], each["trouble"]) for each in told["runs"]] == [(1, 440, "")] * 2
    assert json.loads((tmp_path / "set/meta/info.json").read_text(encoding="utf-8"))["total_frames"] == 880


def test_command_refuses_what_it_cannot_export(kurt2rt: CommandLine, tmp_path: Path) -> None:
    out = ("--out", tmp_path / "set", "--runs", tmp_path)
    assert "no recorded run is there" in kurt2rt.refused("export", "lerobot", *out)
    assert "no recorded run" in kurt2rt.refused("export", "lerobot", "missing", *out)
    assert "30 frames a second" in kurt2rt.refused("export", "lerobot", STORED / "walls.mcap", *out, "--fps", "30")
    (tmp_path / "0001.mcap").write_bytes(b"no recording")
    assert "says of no run" in kurt2rt.refused("export", "lerobot", tmp_path / "0001.mcap", *out)
