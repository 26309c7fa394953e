"""`kurt2rt knowledge show`."""

from typing import Annotated, Any

import typer

from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.knowledge.shared import WIDE, KnowledgeFile
from kurt2rt.cli.tables import console_of
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.show.knowledge import knowledge_data, render_knowledge
from kurt2rt.knowledge.show.rla import expectation_data, render_rla
from kurt2rt.platform.text_table import print_whole


def show(
    file: KnowledgeFile,
    limit: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, help="Show only the oldest so many RLAs; with --rla so many features."),
    ] = None,
    rla: Annotated[
        int | None, typer.Option(metavar="N", help="Show this RLA whole, with what is expected to follow it.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """List each RLA: its action, who taught it and when, instead of what, and its use.

    For example:

        kurt2rt knowledge show var/wall_following.knowledge
        kurt2rt knowledge show var/wall_following.knowledge --rla 3
    """
    with Journal.read_only(file) as journal:
        if as_json:
            print_json(_as_data(journal, rla, limit))
            return
        console = console_of()
        if rla is not None:
            print_whole(console, render_rla(journal, rla, limit))
            return
        print_whole(console, render_knowledge(journal, limit, wide=console.width >= WIDE))


def _as_data(journal: Journal, rla_id: int | None, limit: int | None) -> dict[str, Any]:
    """Return all RLAs, the first `limit` of them, or one with what is expected to follow it."""
    told = knowledge_data(journal)
    if rla_id is None:
        return {**told, "rlas": told["rlas"][:limit], "hidden": len(told["rlas"][limit:]) if limit else 0}
    expected = expectation_data(journal, rla_id)
    (rla,) = (each for each in told["rlas"] if each["rla"] == rla_id)
    return {"file": told["file"], **rla, "expected": expected}
