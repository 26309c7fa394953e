"""Reports at 80 columns: they break no word of the wide report."""

from pathlib import Path

import pytest
from rich.cells import cell_len

from tests.cli.helpers import CommandLine
from tests.runs.replay.stored_runs import STORED

WALLS = str(STORED / "walls.mcap")


def require_whole(narrow: str, wide: str) -> None:
    """Every word of `wide` stands in `narrow`, and no line is longer than 80 cells unless it is one word."""
    shown = set(narrow.replace(": ", " ").split()) | set(narrow.split())
    lines = {word for word in wide.split() if set(word) == {"─"}}
    assert set(wide.split()) - lines - shown == set()
    for line in narrow.splitlines():
        assert cell_len(line) <= 80 or len(line.split()) == 1, line


@pytest.mark.parametrize(
    "words",
    [
        ("knowledge", "list", "."),
        ("knowledge", "lessons", "taught.knowledge"),
        ("knowledge", "show", "taught.knowledge", "--rla", "1"),
        ("pair", "--list"),
        ("why", WALLS, "--to", "30"),
        ("why", WALLS, "--at", "1"),
    ],
    ids=" ".join,
)
def test_commands_break_no_word_at_80_columns(
    kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, lessons: Path, words: tuple[str, ...]
) -> None:
    (tmp_path / "taught.knowledge").write_bytes(lessons.read_bytes())
    folder = tmp_path / "a_folder_with_a_rather_long_name" / "and_another_one_that_is_as_long"
    folder.mkdir(parents=True)
    kurt2rt("knowledge", "export", "taught.knowledge", "--out", "taught.zip")
    assert kurt2rt("knowledge", "import", "taught.zip", "--out", folder / "from-a-friend.knowledge").exit_code == 0
    kurt2rt("pair", "a-device-with-a-long-nam")
    wide = kurt2rt(*words)
    monkeypatch.setenv("COLUMNS", "80")
    narrow = kurt2rt(*words)
    assert (narrow.exit_code, wide.exit_code) == (0, 0), wide.err
    require_whole(narrow.out, wide.out)
