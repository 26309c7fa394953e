"""Options, progress bar and output shared by the commands of `kurt2rt knowledge`."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.runs.replay.trial import Report

WIDE = 140
TEACHER = "command line"
"""Teacher of the lessons that these commands write."""

KnowledgeFile = Annotated[Path, typer.Argument(help="Knowledge file, as kurt2rt train or kurt2rt run leaves it.")]


@contextmanager
def replaying() -> Iterator[Report]:
    """Show the progress of a replay on standard error, if that is a terminal."""
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
    """Print a line to standard output, without markup."""
    Console(highlight=False).print(text, markup=False, soft_wrap=True)


def format_lesson(record: LessonRecord) -> str:
    """Return a lesson in a few words, with its command id."""
    origin = record.event.origin
    return f"{record.text} (lesson {origin.command_id} by {origin.teacher})"
