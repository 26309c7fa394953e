"""Each rule of the checker of words finds its fault, and passes the text that is right."""

import pytest

from tests.lint.rules import WORDS, first_word_rule, python_findings, text_findings


def rules(source: str, path: str = "hal/x.py") -> list[str]:
    return [finding.rule for finding in python_findings(path, f'"""Module."""\n{source}')]


@pytest.mark.parametrize("word", WORDS["banned"])
def test_text_with_banned_word_is_found_at_its_line(word: str) -> None:
    (finding,) = text_findings("README.md", f"Fine.\nSo {word.title()} it is.\n")
    assert (finding.line, finding.rule, finding.name) == (2, "banned-word", word)


def test_text_with_longer_words_is_not_found() -> None:
    assert not list(text_findings("x.md", " ".join(f"x_{word} {word}x" for word in WORDS["banned"])))


@pytest.mark.parametrize(
    ("docstring", "rule"),
    [
        ("What the robot does.", "first-word"),
        ("Whether the robot stands.", "first-word"),
        ("\n    Where it is.", "first-word"),
        ("In metres.", "preposition-first"),
        ("As the settings say.", "preposition-first"),
        ("Return whether the robot stands.", None),
        ("Whatsoever.", None),
        ("Input of the guard.", None),
        ("`what` a caller asked for.", None),
        ("", None),
    ],
)
def test_first_word_of_docstring_breaks_its_rule(docstring: str, rule: str | None) -> None:
    assert first_word_rule(docstring) == rule


@pytest.mark.parametrize(
    "source",
    ['X = 1\n"""{}"""', 'class X:\n    """{}"""', 'class X:\n    x: int\n    """{}"""', 'def _x():\n    """{}"""'],
)
def test_docstrings_of_all_kinds_are_read(source: str) -> None:
    assert rules(source.format("When asked.")) == ["first-word"]
    assert rules(source.format("Answer.")) == []


SHAPED = 'def get(row: NDArray[np.float64]) -> int:\n    """Return the row{}."""'


@pytest.mark.parametrize(
    ("words", "found"), [("", ["shape"]), (" of shape (n,)", []), (" (36,)", []), (" (n, 72)", [])]
)
def test_array_without_shape_is_found(words: str, found: list[str]) -> None:
    assert rules(SHAPED.format(words)) == found


@pytest.mark.parametrize(
    ("signature", "words", "found"),
    [
        ("f(distance: float) -> None", "Move", ["unit"]),
        ("f(distance: float | None) -> None", "Move", ["unit"]),
        ("f(distance: float) -> None", "Move by a distance in m", []),
        ("f(distance: float) -> None", "Move by it's length", ["unit"]),
        ("f(distance_m: float) -> None", "Move", []),
        ("distance() -> float", "Return it", ["unit"]),
        ("distance_m() -> float", "Return it", []),
        ("ratio() -> float", "Return it", []),
        ("f(count: int) -> None", "Move", []),
    ],
)
def test_float_without_unit_is_found(signature: str, words: str, found: list[str]) -> None:
    assert rules(f'def {signature}:\n    """{words}."""') == found


@pytest.mark.parametrize(
    ("body", "words", "found"),
    [
        ("raise ValueError(1)", "Run", ["raises"]),
        ("raise ValueError", "Run", ["raises"]),
        ("raise errors.JunkError(1)", "Run. Raises JunkError", []),
        ("raise errors.JunkError(1)", "Run. Raises XJunkError", ["raises"]),
        ("raise error", "Run", []),
        ("raise", "Run", []),
        ("raise typer.Exit(1)", "Run", []),
        ("def inner():\n        raise ValueError(1)", "Run", []),
        ("if x:\n        raise ValueError(1)", "Run", ["raises"]),
    ],
)
def test_raised_class_without_its_name_is_found(body: str, words: str, found: list[str]) -> None:
    assert rules(f'def run():\n    """{words}."""\n    {body}') == found


def test_constructor_may_name_unit_and_error_in_class_docstring() -> None:
    body = "    def __init__(self, x: float) -> None:\n        raise BusError(x)"
    assert rules(f'class X:\n    """Place in m; raises BusError."""\n{body}') == []
    assert rules(f'class X:\n    """Place."""\n{body}') == ["unit", "raises"]


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("test_what_it_does", ["test-first-word"]),
        ("test_whatever", []),
        ("test_" + "x" * 56, ["test-length"]),
        ("test_" + "x" * 55, []),
        ("helper_" + "x" * 60, []),
    ],
)
def test_name_of_test_is_checked(name: str, found: list[str]) -> None:
    assert rules(f"def {name}(): ...", "tests/test_x.py") == found
    assert rules(f"class TestX:\n    async def {name}(self): ...", "tests/test_x.py") == found
    assert rules(f"def {name}(): ...") == []
