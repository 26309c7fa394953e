"""Tables on standard output, and how a study ends there."""

import os
from typing import TYPE_CHECKING

from rich.console import Console
from rich.text import Text

from kurt2rt.cli.json_output import print_json
from kurt2rt.platform.text_table import print_whole

if TYPE_CHECKING:
    from kurt2rt.experiments.study.table import Told


_UNLIMITED = 100_000


def console_of() -> Console:
    """Return a console on standard output: as wide as the terminal or COLUMNS; a file gets each line whole."""
    console = Console(highlight=False)
    if console.is_terminal or "COLUMNS" in os.environ:
        return console
    return Console(highlight=False, width=_UNLIMITED)


def print_told(told: "Told", *, as_json: bool) -> None:
    """Print the tables of a study, the reasons not to judge it, and the paths of its files; or one JSON document."""
    if as_json:
        # Cells are texts, as they are printed.
        tables = [
            {"title": each.title, "columns": each.columns, "rows": each.rows, "note": each.note} for each in told.tables
        ]
        print_json({"tables": tables, "not_judged": told.not_judged, **told.files, **told.data})
        return
    # Not at the top: the simulator is an extra, and this module is imported without it.
    from kurt2rt.experiments.study.table import as_rich

    reasons = (f"Not judged: {reason}" for reason in told.not_judged)
    to_copy = (Text(line, no_wrap=True) for line in told.lines)
    width = max(map(len, told.files), default=0)
    files = (f"{what:<{width}}  {path}" for what, path in told.files.items())
    print_whole(console_of(), *map(as_rich, told.tables), *reasons, *to_copy, *files)
