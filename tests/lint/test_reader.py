"""Phrases and long sentences are found in all texts that a user reads, at their line, and nowhere else."""

import pytest

from tests.lint.reader import help_findings, reader_findings

LONG = "one " * 22 + "end."


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (f"{LONG}\n", [1]),
        ("one " * 21 + "end. One " + "two " * 20 + "end.\n", []),
        ("# A\n\n| " + "cell " * 30 + "|\n```\n" + "code " * 30 + "\n```\n", []),
        ("- " + "one " * 20 + "\n- " + "two " * 20 + "\n", []),
        ("```\ncode\n```\n\nFine.\n" + "one " * 15 + "\n" + "two " * 8 + "[link](" + "x/" * 9 + ")\n", [6]),
    ],
)
def test_sentence_of_more_than_22_words_is_found_at_its_line(text: str, found: list[int]) -> None:
    assert [finding.line for finding in reader_findings("x.md", text)] == found


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("docs/design.md", "\n{}"),
        ("tests/golden/x.txt", "\ncode: {}"),
        ("tests/golden/x.txt", "\nso many: Short. | {}"),
        ("kurt2rt/teacher/page/static/x.js", '// of "before\n  f("{}")'),
        ("kurt2rt/teacher/page/static/x.js", "\n  f(`{}`)"),
        ("kurt2rt/experiments/x.py", "f(\n    note='{}')"),
        ("kurt2rt/experiments/x.py", "SavedFigure(path, 'So many',\n    '{}')"),
        ("kurt2rt/teacher/page/static/x.html", "<p>\n</p><p>{}</p>"),
        ("kurt2rt/teacher/page/static/x.html", '\n<p title="{}"></p>'),
    ],
)
def test_texts_of_each_surface_are_read(path: str, text: str) -> None:
    phrase, sentence = (list(reader_findings(path, text.format(words))) for words in ("So many it is.", LONG))
    assert [(finding.line, finding.rule, finding.name) for finding in phrase] == [(2, "reader-phrase", "so many")]
    assert [(finding.line, finding.rule) for finding in sentence] == [(2, "long-sentence")]
    assert not list(reader_findings("hal/x.py", text.format(LONG)))


@pytest.mark.parametrize("text", ["There is no way.", "It is no longer here.", "It is not a way."])
def test_plain_words_are_not_phrases(text: str) -> None:
    assert not list(reader_findings("x.md", text))


def test_help_of_all_commands_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.lint.reader.LONGEST_SENTENCE", 3)
    found = {finding.path for finding in help_findings()}
    assert {"kurt2rt/cli", "kurt2rt/cli/run", "kurt2rt/cli/run --bus", "kurt2rt/cli/study/search"} <= found
