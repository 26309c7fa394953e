"""`kurt2rt knowledge branch`."""

from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.cli.knowledge.shared import KnowledgeFile, say
from kurt2rt.knowledge.journal.writer import utc_now
from kurt2rt.knowledge.versions.branch import branch as make_branch


def branch(
    file: KnowledgeFile,
    new: Annotated[Path, typer.Argument(help="The file to make; nothing may be there yet.")],
    at: Annotated[
        str | None,
        typer.Option(help="Last lesson that comes with it, by its id, or a time (ISO 8601, UTC as +00:00); else all."),
    ] = None,
) -> None:
    """Make a new file that begins as FILE was; its lessons can be merged back.

    For example:

        kurt2rt knowledge branch var/streets.knowledge try.knowledge
        kurt2rt knowledge branch mine.knowledge try.knowledge --at LESSON-ID
    """
    made = make_branch(file, new, at, stamp=utc_now())
    say(f"branch  {new}: the first {made.origin.rows} rows of {made.origin.file}")
    if made.skipped_earlier:
        say(
            f"{made.skipped_earlier} later rows bear dates before that, too: the clock was set back meanwhile. "
            "They are not in it; --at with the id of a lesson says how far to go"
        )
