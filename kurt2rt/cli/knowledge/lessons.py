"""`kurt2rt knowledge lessons`."""

from typing import Annotated

import typer

from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.knowledge.shared import KnowledgeFile
from kurt2rt.cli.tables import console_of
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.show.knowledge import lessons_data, render_lessons
from kurt2rt.platform.text_table import print_whole


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
