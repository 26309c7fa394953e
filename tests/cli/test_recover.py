"""`kurt2rt recover`, of a stored run that a power cut tore."""

from pathlib import Path

from mcap.reader import make_reader

from tests.cli.helpers import CommandLine
from tests.replay.stories import STORED


def test_a_torn_run_is_copied_and_the_copy_has_its_index(kurt2rt: CommandLine, tmp_path: Path) -> None:
    content = (STORED / "walls.mcap").read_bytes()
    torn = tmp_path / "walls.mcap"
    torn.write_bytes(content[:-100])
    said = kurt2rt("recover", tmp_path / "copies", torn)
    assert said.exit_code == 0, said.err
    copy = tmp_path / "copies" / "walls.mcap"
    assert f"{torn}: ends without its index" in said.out
    assert f"copied to {copy}" in said.out
    with copy.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == 4400
    again = kurt2rt("recover", tmp_path / "copies", torn)
    assert again.exit_code == 2
    assert "give another folder" in again.err
    assert torn.read_bytes() == content[:-100]
