"""The table of allowed findings refuses more, refuses fewer, and is kept by folder."""

from pathlib import Path

import pytest

from tests.lint.ratchet import counted, differences, findings, folder_of, load_allowed, ruff_findings, write_allowed
from tests.lint.rules import WORDS

PROPERTY = '"""Module."""\n\n\nclass X:\n    """Thing."""\n\n    @property\n    def x(self) -> int:\n        {}\n'


@pytest.mark.parametrize(
    ("path", "folder"),
    [
        ("README.md", "README.md"),
        ("docs/handbook.md", "docs"),
        ("hal/can/bus.py", "hal"),
        ("kurt2rt/core/tick.py", "kurt2rt/core"),
        ("kurt2rt/core/rla/rows/row.py", "kurt2rt/core"),
        ("tests/rla/test_row.py", "tests/rla"),
    ],
)
def test_folder_of_path_is_its_room(path: str, folder: str) -> None:
    assert folder_of(path) == folder


def test_differences_name_more_and_fewer_findings() -> None:
    numbers, allowed = {("hal", "unit"): 2, ("hal", "D401"): 1}, {("hal", "unit"): 1, ("hal", "shape"): 1}
    assert [line.split(": ")[:2] for line in differences(numbers, allowed)] == [
        ["hal", "D401"],
        ["hal", "shape"],
        ["hal", "unit"],
    ]
    assert not list(differences(allowed, allowed))


def test_table_that_was_written_is_read_again(tmp_path: Path) -> None:
    numbers = {("hal", "unit"): 2, (".", "banned-word"): 1, ("kurt2rt/core/rla", "D401"): 3}
    write_allowed(numbers, tmp_path / "allowed.toml")
    assert load_allowed(tmp_path / "allowed.toml") == numbers
    assert load_allowed(tmp_path / "missing.toml") == {}


def test_findings_of_tree_are_counted_by_folder(tmp_path: Path) -> None:
    (tmp_path / "hal").mkdir()
    (tmp_path / "README.md").write_text(WORDS["banned"][0])
    (tmp_path / "hal" / "x.py").write_text('"""What there is."""\n')
    (tmp_path / "hal" / "x.bin").write_bytes(b"\xff")
    assert counted(findings(tmp_path)) == {("README.md", "banned-word"): 1, ("hal", "first-word"): 1}


@pytest.mark.parametrize(("statement", "found"), [("return 1", 0), ("self.y = 1", 1)])
def test_property_without_docstring_may_be_trivial(tmp_path: Path, statement: str, found: int) -> None:
    (tmp_path / "x.py").write_text(PROPERTY.format(statement))
    assert [finding.rule for finding in ruff_findings(tmp_path)] == ["D102"] * found
