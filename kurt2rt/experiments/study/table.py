"""Table for terminal and report."""

from dataclasses import dataclass

from rich.console import Group, RenderableType
from rich.text import Text

from kurt2rt.platform.text_table import TextTable


@dataclass(frozen=True, slots=True)
class Table:
    """Table of texts."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: int = 1
    """So many columns from the left hold words, the others numbers."""
    note: str = ""
    """Explanation below the table."""


def as_rich(table: Table) -> RenderableType:
    """Return the table for the terminal, in plain text: a missed target shows as a word, not as a color."""
    shown = TextTable(title=table.title)
    for place, heading in enumerate(table.columns):
        shown.add_column(heading, number=place >= table.words, whole=place < table.words <= 2)
    for row in table.rows:
        shown.add_row(*row)
    return Group(shown, *([Text(table.note)] if table.note else ()))
