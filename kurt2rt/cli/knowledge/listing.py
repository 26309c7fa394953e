"""`kurt2rt knowledge list`."""

import math
from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.tables import console_of, say
from kurt2rt.knowledge.exchange.package import IMPORTED_FROM
from kurt2rt.knowledge.journal.fold import fold_entries
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.show.table_cells import printable
from kurt2rt.platform.text_table import TextTable, print_whole


def list_files(
    place: Annotated[Path, typer.Argument(help="Folder to look in, and in those below it; or one file.")] = Path("var"),
    as_json: AsJson = False,
) -> None:
    """List the knowledge files of a folder: task, how much they know, and their origin.

    For example:

        kurt2rt knowledge list
        kurt2rt knowledge list results
    """
    if not place.exists():
        raise KnowledgeError(KnowledgeCode.NO_SUCH_FOLDER, where=place)
    paths = sorted(place.rglob("*.knowledge")) if place.is_dir() else [place]
    rows: list[dict[str, object]] = []
    unreadable: dict[Path, str] = {}
    for path in paths:
        try:
            rows.append(_row(path))
        except KnowledgeError as error:
            if not place.is_dir():
                raise
            unreadable[path] = str(error)
    if as_json:
        print_json({"files": rows, "unreadable": [{"file": path, "why": why} for path, why in unreadable.items()]})
        return
    table = TextTable()
    for heading in ("file", "task", "RLAs", "lessons", "newest (UTC)", "came from"):
        table.add_column(heading, number=heading in ("RLAs", "lessons"), whole=heading in ("file", "newest (UTC)"))
    for row in rows:
        table.add_row(*(printable(str(each)) for each in row.values()))
    if rows:
        print_whole(console_of(), table)
    elif not unreadable:
        say(f"{place}: holds no knowledge file (*.knowledge)")
    print_whole(console_of(), *(printable(f"cannot be read: {why}") for why in unreadable.values()))


def _row(path: Path) -> dict[str, object]:
    """Return what the list tells of a file, in the order of its columns."""
    with Journal.read_only(path) as journal:
        entries, came = journal.entries(), journal.notes().get(IMPORTED_FROM, "")
        system = fold_entries(journal, entries, radius=math.inf)
    return {
        "file": path,
        "task": journal.binding.system,
        "rlas": len(system),
        "lessons": system.history.standing,
        "newest": entries[-1].stamped_at[:19].replace("T", " ") if entries else "",
        "came_from": came,
    }
