"""Tables at any width: no word is broken, nothing is lost."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from kurt2rt.platform.text_table import TextTable
from tests.examples import examples

WORDS = st.text(st.characters(categories=("L", "N", "P", "S")), min_size=1, max_size=30)
CELLS = st.lists(WORDS, max_size=8).map(" ".join)
COLUMNS = st.tuples(CELLS, st.sampled_from(["", "number", "whole"]))


@st.composite
def tables(draw: st.DrawFn) -> tuple[TextTable, list[str]]:
    """Return a table and all its words."""
    columns = draw(st.lists(COLUMNS, min_size=1, max_size=9))
    rows = draw(st.lists(st.tuples(*[CELLS] * len(columns)), max_size=4))
    table = TextTable(title=draw(CELLS))
    for heading, kind in columns:
        table.add_column(heading, number=kind == "number", whole=kind == "whole")
    for row in rows:
        table.add_row(*row)
    return table, [word for row in rows for cell in row for word in cell.split()]


@examples(300)
@given(tables(), st.sampled_from([60, 80]))
def test_no_word_is_split_at_any_width(drawn: tuple[TextTable, list[str]], width: int) -> None:
    table, words = drawn
    lines = [line.plain for line in table.lines(width)]
    shown = [word for line in lines for word in line.split()]
    for word in set(words):
        assert shown.count(word) >= words.count(word)
    for line in lines:
        assert cell_len(line) <= width or len(line.split()) == 1, "only one word may be too long"


def table_of(*row: str) -> TextTable:
    table = TextTable("file")
    table.add_column("RLAs", number=True)
    table.add_row(*row)
    return table


def test_table_that_does_not_fit_is_a_block_a_row() -> None:
    table = table_of("var/a_long_name.knowledge", "12")
    table.add_row("b", "3")
    assert [line.plain for line in table.lines(30)] == [
        "file:",
        "  var/a_long_name.knowledge",
        "RLAs: 12",
        "",
        "file: b",
        "RLAs: 3",
    ]


def test_row_with_another_number_of_cells_is_refused() -> None:
    with pytest.raises(ValueError, match=r"\b1 cells\b.*\b2 columns"):
        table_of("a")
