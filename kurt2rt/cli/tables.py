"""Tables on standard output, and how a study ends there."""

import os
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from rich.console import Console, RenderableType
from rich.text import Text

from kurt2rt.cli.json_output import print_json
from kurt2rt.platform.text_table import print_whole

if TYPE_CHECKING:
    from kurt2rt.experiments.study.table import Table, Told


_UNLIMITED = 100_000
_SCREEN = 19
"""Lines of a study's results on a terminal, which leaves one of 20 for what it says before."""


def console_of(*, stderr: bool = False) -> Console:
    """Return a console as wide as the terminal or COLUMNS; a file gets each line whole.

    `stderr`: on standard error instead of standard output.
    """
    console = Console(highlight=False, stderr=stderr)
    if not (console.is_terminal or "COLUMNS" in os.environ):
        console.width = _UNLIMITED
    return console


def say(text: str, style: str = "", *, stderr: bool = False) -> None:
    """Print a paragraph to standard output, or to standard error: notices and errors, no word of them broken."""
    print_whole(console_of(stderr=stderr), Text(text, style))


def print_told(told: "Told", *, as_json: bool) -> None:
    """Print the tables of a study, the reasons not to judge it, and the paths of its files; or one JSON document.

    A terminal shows its sentence, its short table and its files alone.
    """
    if as_json:
        # Cells are texts, as they are printed.
        tables = [
            {"title": each.title, "columns": each.columns, "rows": each.rows, "note": each.note} for each in told.tables
        ]
        print_json({"tables": tables, "not_judged": told.not_judged, **told.files, **told.data})
        return
    # Not at the top: the simulator is an extra, and this module is imported without it.
    from kurt2rt.experiments.study.table import as_rich

    console = console_of()
    width = max(map(len, told.files), default=0)
    files = [f"{what:<{width}}  {path}" for what, path in told.files.items()]
    if told.short is not None and console.is_terminal:
        for parts in _ever_shorter(told, told.short, files):
            with console.capture() as printed:
                print_whole(console, *parts)
            if printed.get().count("\n") <= _SCREEN:
                break
        print_whole(console, *parts)
        return
    reasons = (f"Not judged: {reason}" for reason in told.not_judged)
    to_copy = (Text(line, no_wrap=True) for line in told.lines)
    print_whole(console, *map(as_rich, told.tables), *reasons, *to_copy, *files)


def _ever_shorter(told: "Told", short: "Table", files: list[str]) -> Iterator[list[RenderableType]]:
    """Yield the results for a terminal, with all rows of the short table, then with fewer: missed targets stay."""
    from kurt2rt.experiments.study.table import as_rich

    missed_first = sorted(short.rows, key=lambda row: "MISSED" not in row)
    note = f"Not judged: {told.not_judged[0]}" if told.not_judged else short.note
    to_copy = [Text(line, no_wrap=True) for line in told.lines[:1]]
    yield [told.sentence, as_rich(replace(short, title="", note=note)), *to_copy, *files]
    for left_out in range(1, len(short.rows) + 1):
        kept = tuple(missed_first[:-left_out])
        text = f"More rows in the report: {left_out}. {note}".rstrip()
        yield [told.sentence, as_rich(replace(short, title="", rows=kept, note=text)), *to_copy, *files]
