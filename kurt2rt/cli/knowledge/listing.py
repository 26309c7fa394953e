"""`kurt2rt knowledge list`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.table import Table

from kurt2rt.cli.knowledge.shared import WIDE, say
from kurt2rt.cli.printed import console_of
from kurt2rt.exchange.given import COME_FROM
from kurt2rt.knowledge.branching import whence_of
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.kinship import read_taught
from kurt2rt.knowledge.shown import plain


def list_files(
    place: Annotated[Path, typer.Argument(help="Folder to look in, and in those below it; or one file.")] = Path("var"),
) -> None:
    """List the knowledge files of a folder: task, how much they know, and where it came from."""
    if not place.exists():
        raise KnowledgeError(f"{place}: is not there; give the folder that your knowledge files are in, or one of them")
    table = Table(box=SIMPLE_HEAD)
    for heading in ("file", "task", "RLAs", "lessons", "newest (UTC)", "came from"):
        table.add_column(heading, justify="right" if heading in ("RLAs", "lessons") else "left", overflow="fold")
    if place.is_dir():
        for path in sorted(place.rglob("*.knowledge")):
            try:
                table.add_row(plain(str(path)), *map(plain, _row(path)))
            except KnowledgeError as error:
                table.add_row(plain(str(path)), plain(f"cannot be read: {error}"))
    else:
        table.add_row(plain(str(place)), *map(plain, _row(place)))
    if not table.row_count:
        say(f"{place}: holds no knowledge file (*.knowledge)")
        return
    console_of(WIDE).print(table)


def _row(path: Path) -> tuple[str, ...]:
    with Journal.read_only(path) as journal:
        taught, whence, imported = read_taught(journal), whence_of(journal), journal.notes().get(COME_FROM, "")
    newest = taught.entries[-1].stamped_at[:19].replace("T", " ") if taught.entries else ""
    came = imported if whence is None else f"{whence.file}, {whence.rows} rows"
    system = taught.system
    return journal.binding.system, str(len(system)), str(system.standing_lessons), newest, came
