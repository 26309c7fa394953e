"""`kurt2rt docs`: pages of the checkout, and those of a wheel."""

from importlib import metadata
from pathlib import Path, PurePosixPath

import pytest

from tests.cli.helpers import ROOT, CommandLine

PAGES = sorted(path.stem for path in (ROOT / "docs").glob("*.md"))


def test_list_names_each_page_by_its_title(kurt2rt: CommandLine) -> None:
    said = kurt2rt("docs")
    rows = [line.split(maxsplit=1) for line in said.out.splitlines()[2 : 2 + len(PAGES)]]
    assert [name for name, _ in rows] == PAGES
    assert ["first-day", "First day with a real robot"] in rows


def test_pipe_gets_a_page_as_markdown_and_a_terminal_rendered(
    kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert kurt2rt("docs", "first-day").out == (ROOT / "docs/first-day.md").read_text(encoding="utf-8")
    monkeypatch.setenv("TTY_COMPATIBLE", "1")
    monkeypatch.setenv("COLUMNS", "80")
    shown = kurt2rt("docs", "first-day").out
    assert "Wire it" in shown
    assert "](" not in shown


def test_wrong_page_is_refused_with_the_nearest_name(kurt2rt: CommandLine) -> None:
    said = kurt2rt("docs", "handbok")
    assert (said.exit_code, said.out) == (2, "")
    assert "did you mean handbook?" in said.err


def test_pages_of_a_wheel_are_found(kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "glossary.md").write_text("# Of the wheel\n", encoding="utf-8")

    class Installed(PurePosixPath):
        def locate(self) -> Path:
            return tmp_path / self.name

    monkeypatch.setattr(metadata, "files", lambda _: [Installed("../../share/kurt2rt/docs/glossary.md")])
    assert "Of the wheel" in kurt2rt("docs").out
