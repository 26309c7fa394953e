"""What the commands of `kurt2rt knowledge` share."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from kurt2rt.runs.replay.trial import Report

WIDE = 140
TEACHER = "command line"
"""Who changes a file from here, as its lessons tell."""

KnowledgeFile = Annotated[Path, typer.Argument(help="Knowledge file, as kurt2rt lesson or kurt2rt run leaves it.")]
Recordings = Annotated[
    Path, typer.Option("--runs", help="Folder of recorded runs, or one run of it: they are what it is tried on.")
]


@contextmanager
def replaying() -> Iterator[Report]:
    """A bar on standard error, while it lasts and where that is a terminal: which run is replayed, and how far."""
    columns = (
        TextColumn("replaying {task.description}"),
        BarColumn(bar_width=20),
        TextColumn("{task.completed:.0f} of {task.total:.0f} s"),
        TimeRemainingColumn(),
    )
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        line = progress.add_task("", total=0.0)
        yield lambda run, done_s, whole_s: progress.update(line, description=run, completed=done_s, total=whole_s)


def say(text: str) -> None:
    """A line on standard output, as it is."""
    Console(highlight=False).print(text, markup=False, soft_wrap=True)
