"""Tables for a terminal without broken words: if one is too wide, each row becomes a block of name: value lines."""

import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.measure import Measurement
from rich.segment import Segment
from rich.text import Text

_GAP = 2
_PROSE_CELLS = 20
"""A column of words is not made narrower than this, unless all of its cells are."""
_NAME_CELLS = 24
"""Names of a block stand in a column at most so wide; the value of a longer one follows it."""
_WORD = re.compile(r"\s*\S+\s*")


@dataclass(frozen=True, slots=True)
class Column:
    """Column of a TextTable: its heading, and whether it holds numbers or may not be wrapped."""

    heading: str
    number: bool = False
    """Right-aligned, never wrapped."""
    whole: bool = False
    """Left-aligned, never wrapped: names, ids, paths."""


class TextTable:
    """Table of texts for the terminal, wrapped to its width.

    A cell may hold line breaks. If a row takes several lines, empty lines part the rows. Without any heading there
    is neither a line of headings nor an empty line.
    """

    def __init__(self, *columns: str | Column, title: str = "") -> None:
        """`columns`: in their order, those of words by their headings alone; `add_column` adds others."""
        self.title = title
        self._columns = [Column(each) if isinstance(each, str) else each for each in columns]
        self._rows: list[tuple[Text, ...]] = []

    @property
    def row_count(self) -> int:
        """Number of rows, without the heading."""
        return len(self._rows)

    def add_column(self, heading: str, *, number: bool = False, whole: bool = False) -> None:
        """Add a column on the right; call it before the first row.

        `number`: right-aligned. `whole`: cells are never broken into lines.
        """
        self._columns.append(Column(heading, number, whole))

    def add_row(self, *cells: str | Text) -> None:
        """Add a row at the bottom; strings are taken as they are. Raises ValueError unless each column has a cell."""
        if len(cells) != len(self._columns):
            raise ValueError(f"row has {len(cells)} cells, the table {len(self._columns)} columns")
        self._rows.append(tuple(cell if isinstance(cell, Text) else Text(cell) for cell in cells))

    def lines(self, width: int) -> Iterator[Text]:
        """Yield lines of at most `width` cells, title first; a word that is longer than the line stands whole."""
        if self.title:
            yield from wrapped(Text(self.title, "bold"), width)
        widths = self._widths(width)
        yield from self._blocks(width) if widths is None else self._table(widths)

    def _widths(self, width: int) -> list[int] | None:
        """Return the width of each column; None where the table does not fit into `width`."""
        cells = [[row[place] for row in self._rows] for place in range(len(self._columns))]
        wanted = [
            _longest_line([Text(column.heading), *each]) for column, each in zip(self._columns, cells, strict=True)
        ]
        widths = [_narrowest(column, each) for column, each in zip(self._columns, cells, strict=True)]
        free = width - sum(widths) - _GAP * (len(widths) - 1)
        if free < 0:
            return None
        while free > 0 and (narrow := [place for place, each in enumerate(widths) if each < wanted[place]]):
            widths[max(narrow, key=lambda place: wanted[place] / widths[place])] += 1
            free -= 1
        return widths

    def _table(self, widths: Sequence[int]) -> Iterator[Text]:
        headed = any(column.heading for column in self._columns)
        if headed:
            yield from self._row([Text(column.heading, "bold") for column in self._columns], widths)
            yield Text("─" * (sum(widths) + _GAP * (len(widths) - 1)))
        rows = [list(self._row(row, widths)) for row in self._rows]
        apart = headed and any(len(lines) > 1 for lines in rows)
        for number, lines in enumerate(rows):
            if number and apart:
                yield Text()
            yield from lines

    def _row(self, cells: Sequence[Text], widths: Sequence[int]) -> Iterator[Text]:
        columns = [wrapped(cell, width) for cell, width in zip(cells, widths, strict=True)]
        for pieces in itertools.zip_longest(*columns, fillvalue=Text()):
            line = Text()
            for column, piece, width in zip(self._columns, pieces, widths, strict=True):
                padding = " " * (width - cell_len(piece.plain))
                line = line.append_text(Text(padding) + piece if column.number else piece + Text(padding))
                line.append(" " * _GAP)
            line.rstrip()
            yield line

    def _blocks(self, width: int) -> Iterator[Text]:
        names = [f"{column.heading}: " if column.heading else "" for column in self._columns]
        indent = max((cell_len(name) for name in names if cell_len(name) <= _NAME_CELLS), default=0)
        for number, row in enumerate(self._rows):
            if number:
                yield Text()
            for name, cell in zip(names, row, strict=True):
                if cell.plain.strip():
                    yield from _named(name, cell, indent, width)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        for line in self.lines(options.max_width):
            yield from line.render(console)
            yield Segment.line()

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        widest = max((cell_len(line.plain) for line in self.lines(options.max_width)), default=0)
        return Measurement(widest, widest)


def wrapped(text: Text, width: int) -> list[Text]:
    """Break a text at spaces into lines of at most `width` cells; a longer word has a line of its own."""
    lines: list[Text] = []
    for line in text.split("\n", allow_blank=True):
        breaks, used = [], 0
        for word in _WORD.finditer(line.plain):
            if used and used + cell_len(word[0].rstrip()) > width:
                breaks.append(word.start())
                used = 0
            used += cell_len(word[0])
        pieces = line.divide(breaks)
        for piece in pieces:
            piece.rstrip()
        lines += pieces
    return lines


def print_lines(console: Console, *lines: str, style: str | None = None, whole: bool = False) -> None:
    """Print lines without markup, in no colour but that of `style`; a terminal breaks those that are not `whole`."""
    for line in lines:
        console.print(line, style=style, markup=False, highlight=False, soft_wrap=whole or not console.is_terminal)


def print_whole(console: Console, *parts: RenderableType) -> None:
    """Print tables and paragraphs without breaking a word; an empty line parts a table from what is above and below it.

    A text with `no_wrap`, such as a command to be copied, stays in one line. Raises TypeError for a part that is
    neither a table nor a text.
    """
    below_table, parted = False, True
    for part in _flattened(parts):
        is_table = isinstance(part, TextTable)
        if isinstance(part, TextTable):
            lines = list(part.lines(console.width))
        else:
            lines = [part] if part.no_wrap else wrapped(part, console.width)
        if not parted and (is_table or below_table) and lines and lines[0].plain:
            console.print()
        for line in lines:
            console.print(line, soft_wrap=True, highlight=False)
        below_table, parted = is_table, bool(lines) and not lines[-1].plain


def _flattened(parts: Iterable[RenderableType]) -> Iterator[TextTable | Text]:
    for part in parts:
        if isinstance(part, Group):
            yield from _flattened(part.renderables)
        elif isinstance(part, TextTable | Text):
            yield part
        elif isinstance(part, str):
            yield Text(part)
        else:
            raise TypeError(f"neither a table nor a text: {part!r}")


def _named(name: str, cell: Text, indent: int, width: int) -> Iterator[Text]:
    """Yield the lines of one cell of a block; the value stands below its name if it has no room next to it."""
    room = width - indent
    same_line = cell_len(name) <= indent and _longest_word(cell) <= room
    if not same_line:
        indent = min(indent, _GAP)
        if name:
            yield from wrapped(Text(name.rstrip(), "bold"), width)
    for number, piece in enumerate(wrapped(cell, width - indent)):
        begin = Text(name, "bold") if same_line and not number else Text()
        yield begin + Text(" " * (indent - cell_len(begin.plain))) + piece


def _narrowest(column: Column, cells: Sequence[Text]) -> int:
    heading = _longest_word(Text(column.heading))
    if column.number or column.whole:
        return max(heading, _longest_line(cells))
    return max(heading, min(_longest_line(cells), _PROSE_CELLS), *map(_longest_word, cells), 0)


def _longest_line(texts: Iterable[Text]) -> int:
    return max((cell_len(line) for text in texts for line in text.plain.split("\n")), default=0)


def _longest_word(text: Text) -> int:
    return max((cell_len(word) for word in text.plain.split()), default=0)
