"""`kurt2rt knowledge ...`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from kurt2rt.knowledge.fold import check_knowledge
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.show import render_knowledge

knowledge = typer.Typer(
    help="Look after what the robot was taught. Reads the file also while a robot runs on it; changes nothing.",
    no_args_is_help=True,
)
_WIDE = 140
KnowledgeFile = Annotated[Path, typer.Argument(help="Knowledge file, as kurt2rt lesson or kurt2rt run leaves it.")]


@knowledge.command()
def show(
    file: KnowledgeFile,
    limit: Annotated[int | None, typer.Option(min=1, help="Show only the oldest so many RLAs.")] = None,
) -> None:
    """List each RLA: its action, who taught it and when, instead of what, and how it is used."""
    with Journal.read_only(file) as journal:
        console = Console()
        if not console.is_terminal:
            console = Console(width=_WIDE)  # into a file or a pager the table goes at its full width
        console.print(render_knowledge(journal, limit, wide=console.width >= _WIDE))


@knowledge.command()
def check(file: KnowledgeFile) -> None:
    """Check that every lesson in the file can be read and fits; exit code 1 when something does not."""
    with Journal.read_only(file) as journal:
        faults = check_knowledge(journal)
    for fault in faults:
        typer.echo(fault)
    if faults:
        raise typer.Exit(1)
    typer.echo(f"{file}: every lesson can be read and fits")
