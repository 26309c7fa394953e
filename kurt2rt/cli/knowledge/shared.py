"""What the commands of `kurt2rt knowledge` share."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress, TextColumn, TimeElapsedColumn

WIDE = 140
TEACHER = "command line"
"""Who changes a file from here, as its lessons tell."""

KnowledgeFile = Annotated[Path, typer.Argument(help="Knowledge file, as kurt2rt lesson or kurt2rt run leaves it.")]
Recordings = Annotated[
    Path, typer.Option("--runs", help="Folder of recorded runs, or one run of it: they are what it is tried on.")
]


@contextmanager
def replaying() -> Iterator[Callable[[str, int], None]]:
    """Tells on standard error, while it lasts, which run is replayed and how far."""
    columns = (
        TextColumn("replaying {task.description}"),
        TextColumn("{task.completed:.0f} ticks"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        line = progress.add_task("")
        yield lambda run, ticks: progress.update(line, description=run, completed=ticks)


def say(text: str) -> None:
    """A line on standard output, as it is."""
    Console(highlight=False).print(text, markup=False, soft_wrap=True)
