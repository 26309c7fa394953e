"""A table as it is read, on the terminal and in the report."""

from dataclasses import dataclass

from rich.console import Group, RenderableType
from rich.text import Text

from kurt2rt.platform.text_table import TextTable


@dataclass(frozen=True, slots=True)
class Table:
    """Cells are texts."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: int = 1
    """So many columns from the left hold words, the others numbers."""
    note: str = ""
    """What one has to know to read it."""


def as_rich(sheet: Table) -> RenderableType:
    """For the terminal. Plain text: what is missed is said in a word, not in a colour."""
    table = TextTable(title=sheet.title)
    for place, heading in enumerate(sheet.columns):
        table.add_column(heading, number=place >= sheet.words, whole=place < sheet.words <= 2)
    for row in sheet.rows:
        table.add_row(*row)
    return Group(table, *([Text(sheet.note)] if sheet.note else ()))
