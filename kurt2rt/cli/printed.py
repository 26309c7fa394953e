"""Tables on standard output, and how a study ends there."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

if TYPE_CHECKING:
    from kurt2rt.experiments.shown.sheet import Sheet


def console_of(width: int) -> Console:
    """The terminal as it is; into a file or a pager a table goes at its full `width`."""
    console = Console()
    return console if console.is_terminal else Console(width=width)


def print_study(sheets: "Iterable[Sheet]", reasons_not_to_judge: Iterable[str], report: Path, *, width: int) -> None:
    """Its tables, why some of it was not judged, and where the report is."""
    # Not at the top: the simulator is an extra, and this module is imported without it.
    from kurt2rt.experiments.shown.sheet import as_rich

    console = console_of(width)
    for sheet in sheets:
        console.print(as_rich(sheet))
    for reason in reasons_not_to_judge:
        console.print(f"Not judged: {reason}", markup=False, highlight=False, soft_wrap=True)
    console.print(f"report  {report}", markup=False, highlight=False, soft_wrap=True)
