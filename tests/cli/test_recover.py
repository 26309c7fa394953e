"""`kurt2rt recover`, of a stored run that a power cut tore."""

from pathlib import Path

from mcap.reader import make_reader

from kurt2rt.runs.recording.recording import LAYOUT
from tests.cli.helpers import CommandLine
from tests.runs.replay.stored_runs import STORED


def test_recover_copies_a_torn_run_with_an_index(kurt2rt: CommandLine, tmp_path: Path) -> None:
    content = (STORED / "walls.mcap").read_bytes()
    truncated = tmp_path / "walls.mcap"
    truncated.write_bytes(content[:-100])
    said = kurt2rt("recover", tmp_path / "copies", truncated)
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
    again = kurt2rt("recover", tmp_path / "copies", truncated)
    assert again.exit_code == 2
    assert str(copy) in again.err
    assert truncated.read_bytes() == content[:-100]


def test_recover_skips_an_empty_segment_and_copies_the_others(kurt2rt: CommandLine, tmp_path: Path) -> None:
    run = tmp_path / "20260320T094640Z-wall_following"
    run.mkdir()
    for number in (1, 3):
        (run / f"000{number}.mcap").write_bytes((STORED / "walls.mcap").read_bytes()[:200_000])
    (run / "0002.mcap").touch()
    said = kurt2rt("recover", tmp_path / "copies", run)
    assert said.exit_code == 0, said.err
    assert f"{run / '0002.mcap'}: " in said.out
    assert sorted(copy.name for copy in (tmp_path / "copies").iterdir()) == ["0001.mcap", "0003.mcap"]
    assert f"{run / '0002.mcap'}: " in kurt2rt.refused("recover", tmp_path / "others", run / "0002.mcap")
