"""The end of a study: what fits a screen on a terminal, and everything in a pipe."""

import io
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from kurt2rt.cli.tables import print_told, say
from kurt2rt.experiments.study.table import Told, Verdict, brief, targets_table

VERDICTS = [
    ((), Verdict(f"exams passed in world {number}", "at least 18 of 20", "20 of 20", number != 37))
    for number in range(40)
]
TARGETS = targets_table(VERDICTS, ())
TOLD = Told([TARGETS], "39 of 40 robots are right.", short=TARGETS, files={"report": Path("made/report.html")})


@pytest.mark.parametrize("columns", [80, 40])
def test_a_terminal_gets_at_most_19_lines_and_each_missed_target(monkeypatch: pytest.MonkeyPatch, columns: int) -> None:
    screen = io.StringIO()
    console = Console(file=screen, width=columns, force_terminal=True, color_system=None)
    monkeypatch.setattr("kurt2rt.cli.tables.console_of", lambda: console)
    told = replace(TOLD, short=replace(TARGETS, note="Once more:"), lines=("kurt2rt exam one", "kurt2rt exam two"))
    print_told(told, as_json=False)
    lines = screen.getvalue().splitlines()
    assert len(lines) <= 19
    assert max(map(len, lines)) <= columns
    assert lines[0] == TOLD.sentence
    assert any("MISSED" in line for line in lines)
    assert "More rows in the report:" in " ".join(lines)
    assert lines[-3].endswith("Once more:")
    assert lines[-2:] == ["kurt2rt exam one", "report  made/report.html"]


def test_ten_long_targets_fit_a_screen_of_80_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = io.StringIO()
    console = Console(file=screen, width=80, force_terminal=True, color_system=None)
    monkeypatch.setattr("kurt2rt.cli.tables.console_of", lambda: console)
    asked, came = "at most 2% worse, at the bad end of 95 %", "1.000 -> 1.000, at worst 1.5% worse"
    long = [((), Verdict(f"intact, A: action changes per s {at}", asked, came, at != 3)) for at in range(10)]
    sentence = "Exams passed without a teacher: 60 of 60 (94% to 100%) after answers and corrections; 6 of 6 at last."
    print_told(replace(TOLD, sentence=sentence, short=brief(targets_table(long, ()))), as_json=False)
    lines = screen.getvalue().splitlines()
    assert len(lines) <= 19
    assert sum("at most 2% worse  1.000 -> 1.000  " in line for line in lines) == 10


def test_a_pipe_gets_all_rows(capsys: pytest.CaptureFixture[str]) -> None:
    print_told(TOLD, as_json=False)
    assert capsys.readouterr().out.count("exams passed in world") == 40


def test_an_error_is_broken_between_words_alone(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "/a/folder/with/a/long/name.knowledge: cannot be read; give the path of a knowledge file"
    for columns, lines in (("40", 3), ("", 1)):
        monkeypatch.setenv("COLUMNS", columns) if columns else monkeypatch.delenv("COLUMNS")
        say(text, "red", stderr=True)
        printed = capsys.readouterr().err.splitlines()
        assert len(printed) == lines
        assert " ".join(printed) == text
        assert "knowledge file" in printed[-1]
