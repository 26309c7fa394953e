"""`kurt2rt knowledge show`."""

from typing import Annotated

import typer

from kurt2rt.cli.knowledge.shared import WIDE, KnowledgeFile
from kurt2rt.cli.printed import console_of
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.show import render_knowledge
from kurt2rt.knowledge.show_rla import render_rla
from kurt2rt.text_table import print_whole


def show(
    file: KnowledgeFile,
    limit: Annotated[
        int | None, typer.Option(min=1, help="Show only the oldest so many RLAs; with --rla so many features.")
    ] = None,
    rla: Annotated[int | None, typer.Option(help="Show this RLA whole, with what is expected to follow it.")] = None,
) -> None:
    """List each RLA: its action, who taught it and when, instead of what, and how it is used."""
    with Journal.read_only(file) as journal:
        console = console_of()
        if rla is not None:
            print_whole(console, render_rla(journal, rla, limit))
            return
        print_whole(console, render_knowledge(journal, limit, wide=console.width >= WIDE))
