"""`kurt2rt recording`, of the stored runs."""

import json
from pathlib import Path

import pytest
from mcap.reader import make_reader

from kurt2rt.runs.recording.recording import LAYOUT
from tests.cli.helpers import CommandLine
from tests.runs.replay.stored_runs import STORED


def test_list_shows_each_run_and_why_one_cannot_be_read(kurt2rt: CommandLine, tmp_path: Path) -> None:
    for name, content in (("1-walls", (STORED / "walls.mcap").read_bytes()), ("2-torn", b"no recording")):
        folder = tmp_path / f"20260320T09464{name[0]}Z{name[1:]}"
        folder.mkdir()
        (folder / "0001.mcap").write_bytes(content)
    walls, torn = json.loads(kurt2rt("recording", "list", "--runs", tmp_path, "--json").out)["runs"]
    assert (walls["run"], walls["task"], walls["note"]) == ("20260320T094641Z-walls", "wall_following", "")
    assert walls["seconds"] == pytest.approx(43.99)
    assert "says of no run" in torn["note"]
    said = kurt2rt("recording", "list", "--runs", tmp_path)
    assert "20260320T094642Z-torn" in said.out
    assert "holds no recorded run" in kurt2rt("recording", "list", "--runs", "empty").out


def test_repair_copies_a_torn_run_with_an_index(kurt2rt: CommandLine, tmp_path: Path) -> None:
    content = (STORED / "walls.mcap").read_bytes()
    truncated = tmp_path / "walls.mcap"
    truncated.write_bytes(content[:-100])
    said = kurt2rt("recording", "repair", truncated, "--out", tmp_path / "copies")
    assert said.exit_code == 0, said.err
    copy = tmp_path / "copies" / "walls.mcap"
    assert f"{truncated}: " in said.out
    assert str(copy) in said.out
    assert LAYOUT.is_file()
    assert said.out.endswith(f"layout for Foxglove: {LAYOUT}\n")
    with copy.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == 4400
    again = kurt2rt("recording", "repair", truncated, "--out", tmp_path / "copies")
    assert again.exit_code == 2
    assert str(copy) in again.err
    assert truncated.read_bytes() == content[:-100]


def test_repair_skips_an_empty_segment_and_copies_the_others(kurt2rt: CommandLine, tmp_path: Path) -> None:
    run = tmp_path / "20260320T094640Z-wall_following"
    run.mkdir()
    for number in (1, 3):
        (run / f"000{number}.mcap").write_bytes((STORED / "walls.mcap").read_bytes()[:200_000])
    (run / "0002.mcap").touch()
    said = kurt2rt("recording", "repair", run, "--out", tmp_path / "copies")
    assert said.exit_code == 0, said.err
    assert f"{run / '0002.mcap'}: " in said.out
    assert sorted(copy.name for copy in (tmp_path / "copies").iterdir()) == ["0001.mcap", "0003.mcap"]
    assert f"{run / '0002.mcap'}: " in kurt2rt.refused("recording", "repair", run / "0002.mcap", "--out", "others")


def test_export_writes_several_runs(kurt2rt: CommandLine, tmp_path: Path) -> None:
    walls, errand = STORED / "walls.mcap", STORED / "errand.mcap"
    said = kurt2rt("recording", "export", walls, errand, walls, "--out", tmp_path / "set", "--fps", "10", "--json")
    assert said.exit_code == 0, said.err
    told = json.loads(said.out)
    assert (told["folder"], told["fps"]) == (str(tmp_path / "set"), 10)
    assert [(each["episodes"], each["frames"], each["trouble"]) for each in told["runs"]] == [(1, 440, "")] * 2
    assert json.loads((tmp_path / "set/meta/info.json").read_text(encoding="utf-8"))["total_frames"] == 880


def test_export_refuses_what_it_cannot_write(kurt2rt: CommandLine, tmp_path: Path) -> None:
    out = ("--out", tmp_path / "set", "--runs", tmp_path)
    assert "no recorded run is there" in kurt2rt.refused("recording", "export", *out)
    assert "no recorded run" in kurt2rt.refused("recording", "export", "missing", *out)
    assert "30 frames a second" in kurt2rt.refused("recording", "export", STORED / "walls.mcap", *out, "--fps", "30")
    (tmp_path / "0001.mcap").write_bytes(b"no recording")
    assert "says of no run" in kurt2rt.refused("recording", "export", tmp_path / "0001.mcap", *out)
