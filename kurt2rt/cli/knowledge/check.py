"""`kurt2rt knowledge check`."""

import typer

from kurt2rt.cli.knowledge.shared import KnowledgeFile
from kurt2rt.knowledge.fold import check_knowledge
from kurt2rt.knowledge.journal import Journal


def check(file: KnowledgeFile) -> None:
    """Check that every lesson in the file can be read and fits; exit code 1 when something does not."""
    with Journal.read_only(file) as journal:
        faults = check_knowledge(journal)
    for fault in faults:
        typer.echo(fault)
    if faults:
        raise typer.Exit(1)
    typer.echo(f"{file}: every lesson can be read and fits")
