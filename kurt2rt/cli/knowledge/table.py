"""`kurt2rt knowledge table`."""

from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.knowledge.shared import KnowledgeFile, say
from kurt2rt.knowledge.files.table import export_table
from kurt2rt.knowledge.journal import journal_file
from kurt2rt.knowledge.journal.writer import utc_now


def table(
    file: KnowledgeFile,
    out: Annotated[Path, typer.Option(help="Folder for the table; made where it is missing.")] = Path("results/export"),
    as_json: AsJson = False,
) -> None:
    """Write the RLAs as a table (CSV): one row each, with condition, teacher and use.

    Numbers are exact. A text that a spreadsheet would run as a formula gets an
    apostrophe before it.

    For example:

        kurt2rt knowledge table var/wall_following.knowledge --out results/export
    """
    journal_file.require_ours(file)
    saved = export_table(file, out, utc_now())
    if as_json:
        print_json({"table": out / saved.name, "sha256": saved.sha256})
        return
    say(f"table  {out / saved.name}")
    say(f"sha256  {saved.sha256}")
