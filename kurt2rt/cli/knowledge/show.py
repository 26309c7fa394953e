"""`kurt2rt knowledge show`, `lessons` and `check`."""

from typing import Annotated, Any

import typer

from hal.errors import ExitCode
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.knowledge.shared import WIDE, KnowledgeFile
from kurt2rt.cli.tables import console_of
from kurt2rt.knowledge.journal.fold import check_knowledge
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.show.knowledge import knowledge_data, lessons_data, render_knowledge, render_lessons
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


def lessons(
    file: KnowledgeFile,
    limit: Annotated[int, typer.Option(metavar="N", min=1, help="Show only the newest so many lessons.")] = 20,
    of: Annotated[str | None, typer.Option(help="Only those of this teacher; the critic's are of: critic.")] = None,
    as_json: AsJson = False,
) -> None:
    """List the lessons, newest first, with their ids and who undid them.

    For example:

        kurt2rt knowledge lessons var/wall_following.knowledge
        kurt2rt knowledge lessons var/wall_following.knowledge --of critic
    """
    with Journal.read_only(file) as journal:
        if as_json:
            print_json(lessons_data(journal, limit, of))
        else:
            print_whole(console_of(), render_lessons(journal, limit, of))


def check(file: KnowledgeFile, as_json: AsJson = False) -> None:
    """Check that every lesson in the file can be read and fits; exit code 1 if one does not.

    For example:

        kurt2rt knowledge check var/wall_following.knowledge
    """
    with Journal.read_only(file) as journal:
        faults = [str(error) for error in check_knowledge(journal)]
    if as_json:
        print_json({"file": file, "sound": not faults, "faults": faults})
    else:
        for line in faults or [f"{file}: every lesson can be read and fits"]:
            typer.echo(line)
    if faults:
        raise typer.Exit(ExitCode.FAILED)


def _as_data(journal: Journal, rla_id: int | None, limit: int | None) -> dict[str, Any]:
    """Return all RLAs, the first `limit` of them, or one with what is expected to follow it."""
    data = knowledge_data(journal)
    if rla_id is None:
        return {**data, "rlas": data["rlas"][:limit], "hidden": len(data["rlas"][limit:]) if limit else 0}
    expected = expectation_data(journal, rla_id)
    (rla,) = (each for each in data["rlas"] if each["rla"] == rla_id)
    return {"file": data["file"], **rla, "expected": expected}
