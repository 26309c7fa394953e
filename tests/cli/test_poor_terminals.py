"""Terminals whose encoding lacks letters, or which tell no width: the same exit code and text, no traceback."""

import io
import sys
from pathlib import Path

import pytest
from rich.console import Console

from kurt2rt.cli.live_screen import LiveScreen
from kurt2rt.cli.qr_code import NO_CODE
from kurt2rt.teacher.page.served_pages import PageAddress, ServedPages
from tests.cli.helpers import CommandLine

REPORTS: tuple[tuple[str, ...], ...] = (
    *(("--version",), ("plugin", "list"), ("pair", "--list"), ("pair", "phone")),
    *(("service", "show", "--bus", "can0"), ("status",), ("knowledge", "list", ".")),
    *(("knowledge", "show", "taught.knowledge", "--rla", "1"), ("knowledge", "check", "taught.knowledge")),
    ("exam", "taught.knowledge", "--world", "nowhere-\udcff"),
)


class Terminals:
    """Run commands with an output of any encoding."""

    def __init__(self, kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch) -> None:
        self._kurt2rt, self._monkeypatch = kurt2rt, monkeypatch

    def __call__(self, *words: str, encoding: str = "utf-8", columns: str | None = None) -> tuple[int, str, str]:
        raw = io.BytesIO()
        stream = io.TextIOWrapper(raw, encoding=encoding, write_through=True)
        with self._monkeypatch.context() as changed:
            changed.setattr(sys, "stdout", stream)
            if columns is not None:
                changed.setenv("COLUMNS", columns)
            said = self._kurt2rt(*words)
        return said.exit_code, raw.getvalue().decode(encoding), said.err


@pytest.fixture
def terminals(kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch, lessons: Path, tmp_path: Path) -> Terminals:
    (tmp_path / "taught.knowledge").write_bytes(lessons.read_bytes())
    return Terminals(kurt2rt, monkeypatch)


@pytest.mark.parametrize("words", REPORTS, ids=" ".join)
def test_reports_are_alike_on_every_terminal(terminals: Terminals, words: tuple[str, ...]) -> None:
    wide = terminals(*words)
    again = (*words, "--renew") if words == ("pair", "phone") else words
    for encoding, columns in (("ascii", None), ("latin-1", None), ("utf-8", "0"), ("utf-8", "1")):
        poor = terminals(*again, encoding=encoding, columns=columns)
        assert poor[0] == wide[0], poor[2]
        assert len(poor[2]) == len(wide[2])
        if words == ("pair", "phone"):
            assert ("█" in poor[1], NO_CODE in poor[1]) == (encoding == "utf-8", encoding != "utf-8")
        else:
            assert poor[1] == wide[1].encode(encoding, "replace").decode(encoding)


def test_live_screen_without_blocks_says_so() -> None:
    raw = io.BytesIO()
    screen = LiveScreen(
        Console(file=io.TextIOWrapper(raw, encoding="ascii"), force_terminal=True, width=200, _environ={}),
        for_phones=True,
    )
    screen.pin(ServedPages((PageAddress("phone", "http://10.42.0.1/"),), network=True, trouble=""))
    assert NO_CODE in raw.getvalue().decode()
