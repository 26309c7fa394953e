"""A table as it is read, on the terminal and in the report."""

from dataclasses import dataclass
from typing import Literal

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text


@dataclass(frozen=True, slots=True)
class Sheet:
    """Cells are texts."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: int = 1
    """So many columns from the left hold words, the others numbers."""
    note: str = ""
    """What one has to know to read it."""


def as_rich(sheet: Sheet) -> RenderableType:
    """For the terminal. Plain text: what is missed is said in a word, not in a colour."""
    table = Table(box=SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False)
    for place, heading in enumerate(sheet.columns):
        is_name = place < sheet.words <= 2
        justify: Literal["left", "right"] = "left" if place < sheet.words else "right"
        table.add_column(heading, justify=justify, overflow="fold", no_wrap=is_name)
    for row in sheet.rows:
        table.add_row(*map(Text, row))
    # Not the table's own title and caption, which a narrow table would wrap.
    return Group(Text(f"\n{sheet.title}", "bold"), table, *([Text(sheet.note)] if sheet.note else ()))
