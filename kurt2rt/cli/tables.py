"""Tables on standard output, and how a study ends there."""

import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from kurt2rt.cli.json_output import print_json
from kurt2rt.platform.text_table import print_whole

if TYPE_CHECKING:
    from kurt2rt.experiments.study.table import Table


_UNLIMITED = 100_000


def console_of() -> Console:
    """Return a console on standard output: as wide as the terminal or COLUMNS; a file gets each line whole."""
    console = Console(highlight=False)
    if console.is_terminal or "COLUMNS" in os.environ:
        return console
    return Console(highlight=False, width=_UNLIMITED)


def print_study(
    tables: "Iterable[Table]", reasons_not_to_judge: Iterable[str], *, as_json: bool = False, **files: Path
) -> None:
    """Print the tables of a study, the reasons not to judge it, and the paths of the files that it leaves.

    `as_json`: as one JSON document. `files`: by what they are, such as report.
    """
    if as_json:
        print_json({"tables": tables_of(tables), "not_judged": list(reasons_not_to_judge), **files})
        return
    # Not at the top: the simulator is an extra, and this module is imported without it.
    from kurt2rt.experiments.study.table import as_rich

    console = console_of()
    print_whole(console, *map(as_rich, tables), *(f"Not judged: {reason}" for reason in reasons_not_to_judge))
    print_whole(console, *(f"{what}  {path}" for what, path in files.items()))


def tables_of(tables: "Iterable[Table]") -> list[dict[str, Any]]:
    """Return tables for JSON: cells are texts, as they are printed."""
    return [{"title": each.title, "columns": each.columns, "rows": each.rows, "note": each.note} for each in tables]
