"""`kurt2rt docs`: the documentation's pages, which every installation carries."""

from importlib import metadata
from pathlib import Path
from typing import Annotated

import typer
from rich.markdown import Markdown

from config.errors import UserError, guess
from kurt2rt.cli.tables import console_of
from kurt2rt.platform.text_table import Column, TextTable, print_whole


def docs(
    page: Annotated[
        str | None, typer.Argument(help="Page to read, such as handbook; without one, all are listed.")
    ] = None,
) -> None:
    """List the pages of the documentation, or read one here.

    Needs no network. A pipe or file gets the page as Markdown. The list ends with
    the folder of the pages and their pictures.

    For example:

        kurt2rt docs
        kurt2rt docs handbook
    """
    folder = _folder()
    pages = {path.stem: path for path in sorted(folder.glob("*.md"))}
    console = console_of()
    if page is None:
        table = TextTable(Column("page", whole=True), "title")
        for name, path in pages.items():
            table.add_row(name, path.read_text(encoding="utf-8").splitlines()[0].removeprefix("# "))
        print_whole(console, table, f"folder  {folder}")
        return
    if page not in pages:
        raise UserError("no such page", where=page, do=f"one of: {', '.join(pages)}{guess(page, pages)}")
    text = pages[page].read_text(encoding="utf-8")
    if not console.is_terminal:
        typer.echo(text, nl=False)
        return
    with console.pager(styles=True):
        console.print(Markdown(text))


def _folder() -> Path:
    """Return the folder of the pages: that of the installed wheel, or of the checkout if it is installed editable."""
    for file in metadata.files("kurt2rt") or ():
        if file.match("share/kurt2rt/docs/*.md"):
            return Path(file.locate()).resolve().parent
    return Path(__file__).parents[2] / "docs"
