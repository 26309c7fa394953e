"""What the commands of `kurt2rt knowledge` share."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

WIDE = 140
TEACHER = "command line"
"""Who changes a file from here, as its lessons tell."""

KnowledgeFile = Annotated[Path, typer.Argument(help="Knowledge file, as kurt2rt lesson or kurt2rt run leaves it.")]


def say(text: str) -> None:
    """A line on standard output, as it is."""
    Console(highlight=False).print(text, markup=False, soft_wrap=True)
