"""Table for terminal and report, from rows and columns."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeVar

from rich.console import Group, RenderableType
from rich.text import Text

from kurt2rt.experiments.study.intervals import quartiles, wilson_interval
from kurt2rt.platform.text_table import TextTable

RowT = TypeVar("RowT")


@dataclass(frozen=True, slots=True)
class Table:
    """Table of texts for terminal and report, with title and note."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: int = 1
    """So many columns from the left hold words, the others numbers."""
    note: str = ""
    """Explanation below the table."""


def table_of(
    title: str,
    rows: Iterable[RowT],
    *columns: tuple[str, Callable[[RowT], object]],
    words: int = 1,
    note: str = "",
) -> Table:
    """Return a table with a row for each of `rows`.

    Args:
        title: of the table.
        rows: things to show.
        columns: heading of each column, and the function from a row to what its cell shows.
        words: number of columns from the left that hold words.
        note: explanation below the table.
    """
    cells = tuple(tuple(str(of(row)) for _, of in columns) for row in rows)
    return Table(title, tuple(heading for heading, _ in columns), cells, words, note)


def as_rich(table: Table) -> RenderableType:
    """Return the table for the terminal, in plain text: a missed target shows as a word, not as a color."""
    shown = TextTable(title=table.title)
    for place, heading in enumerate(table.columns):
        shown.add_column(heading, number=place >= table.words, whole=place < table.words <= 2)
    for row in table.rows:
        shown.add_row(*row)
    return Group(shown, *([Text(table.note)] if table.note else ()))


def median(values: Iterable[float]) -> float:
    """Return the median of values, such as counts or seconds; of two middle values their mean."""
    return quartiles(list(values))[1]


def of_text(count: int, whole: int, *, interval: bool = False) -> str:
    """Return `18 of 20`; `none judged` of none. `interval`: with the 95 % interval of the share."""
    if not whole and interval:
        return "none judged"
    text = f"{count} of {whole}"
    return f"{text} ({share_text(count, whole)})" if interval else text


def share_text(count: int, whole: int) -> str:
    """Return the 95 % interval of a share, such as `44% to 100%`; empty of none."""
    return to_text(wilson_interval(count, whole), ".0%") if whole else ""


def to_text(ends: Iterable[float], form: str) -> str:
    """Return `1.5 to 2.5`: the ends of an interval, each in the format `form`."""
    low, high = ends
    return f"{low:{form}} to {high:{form}}"


def collisions_text(collisions: int) -> str:
    """Return a number of collisions in words, such as `2 collisions`."""
    return f"{collisions} collision{'' if collisions == 1 else 's'}"
