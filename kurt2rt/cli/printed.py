"""Tables on standard output, and how a study ends there."""

import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from kurt2rt.text_table import print_whole

if TYPE_CHECKING:
    from kurt2rt.experiments.shown.sheet import Sheet


_UNLIMITED = 100_000


def console_of() -> Console:
    """Return standard output: as wide as the terminal or COLUMNS; a file or a pager gets each line whole."""
    console = Console(highlight=False)
    if console.is_terminal or "COLUMNS" in os.environ:
        return console
    return Console(highlight=False, width=_UNLIMITED)


def print_study(sheets: "Iterable[Sheet]", reasons_not_to_judge: Iterable[str], report: Path) -> None:
    """Its tables, why some of it was not judged, and where the report is."""
    # Not at the top: the simulator is an extra, and this module is imported without it.
    from kurt2rt.experiments.shown.sheet import as_rich

    console = console_of()
    print_whole(console, *map(as_rich, sheets), *(f"Not judged: {reason}" for reason in reasons_not_to_judge))
    print_whole(console, f"report  {report}")
