"""`kurt2rt knowledge merge`."""

from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.cli.knowledge.shared import KnowledgeFile, format_lesson
from kurt2rt.cli.tables import say
from kurt2rt.knowledge.versions.merge import merge as append_lessons


def merge(
    file: KnowledgeFile,
    other: Annotated[Path, typer.Argument(help="File whose lessons are added; it stays as it is.")],
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only show what a merge would change.")] = False,
) -> None:
    """Append the lessons of OTHER, except undone ones, to FILE; merging again adds nothing.

    A lesson corrects or rewards an RLA. If this RLA is gone from FILE, or has
    another action there, the lesson is left out and listed. A merge can be
    undone as a whole.

    For example:

        kurt2rt knowledge merge mine.knowledge yours.knowledge --dry-run
        kurt2rt knowledge merge mine.knowledge yours.knowledge
    """
    merged = append_lessons(file, other, dry_run=dry_run)
    for record in merged.left_out:
        say(f"left out, as it does not fit here: {format_lesson(record)}")
    if merged.stay_undone:
        say(f"{merged.stay_undone} of its lessons were undone here, and stay so")
    if not merged.lessons:
        say(f"{file}: nothing is there that is not here")
        return
    would = "would be " if dry_run else ""
    say(f"{file}: {would}brought in: {merged.lessons} lessons, {merged.new_rlas} RLAs of them new")
    undo = f"to undo that: kurt2rt knowledge undo {file} --lesson {merged.merge_id}"
    say("nothing was changed: --dry-run" if dry_run else undo)
