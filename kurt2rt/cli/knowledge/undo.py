"""`kurt2rt knowledge undo` and `redo`."""

from typing import Annotated

import typer

from kurt2rt.cli.knowledge.confirm import DryRun, NoPreview, Runs, Yes, confirmed, format_lesson
from kurt2rt.cli.knowledge.shared import TEACHER, KnowledgeFile, say
from kurt2rt.core.outcome_text import text_of
from kurt2rt.knowledge.journal.writer import utc_now
from kurt2rt.knowledge.versions.undo import apply_plan, plan_redo, plan_undo


def undo(
    file: KnowledgeFile,
    lesson: Annotated[
        str | None,
        typer.Option(help="Id of the lesson, hold or merge, as knowledge lessons lists it. Default: the newest."),
    ] = None,
    teacher: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="All lessons of this teacher, newest first; critic: the robot's own critic.",
        ),
    ] = None,
    runs: Runs = None,
    no_preview: NoPreview = False,
    dry_run: DryRun = False,
    yes: Yes = False,
) -> None:
    """Undo a lesson, a merge, or all of one teacher: what it changed is as before.

    It first replays the newest recorded run of this knowledge, and shows the
    decisions that differ without the lesson. At a terminal it then asks.

    For example:

        kurt2rt knowledge undo var/wall_following.knowledge
        kurt2rt knowledge undo var/wall_following.knowledge --teacher anna-phone --dry-run
    """
    _require_one_of(lesson, teacher)
    planned = plan_undo(file, lesson, teacher, teacher=TEACHER)
    if not confirmed(planned, "undo", "undone", runs, no_preview=no_preview, dry_run=dry_run, yes=yes):
        return
    apply_plan(planned, utc_now())
    for record in planned.lessons:
        say(f"{file}: undone: {format_lesson(record)}")
    if teacher is not None:
        say(f"{file}: {len(planned.lessons)} lessons of {teacher} undone")


def redo(
    file: KnowledgeFile,
    lesson: Annotated[
        str | None,
        typer.Option(help="Id of the lesson, hold or merge, as lessons and merge show it; else the one undone last."),
    ] = None,
    teacher: Annotated[
        str | None, typer.Option(help="All lessons of this teacher that were undone, the one undone last first.")
    ] = None,
    runs: Runs = None,
    no_preview: NoPreview = False,
    dry_run: DryRun = False,
    yes: Yes = False,
) -> None:
    """Redo a lesson that was undone, or all of one teacher, if its RLA is as the lesson found it.

    It first shows the decisions that differ with the lesson, and asks, as undo.

    For example:

        kurt2rt knowledge redo var/wall_following.knowledge
        kurt2rt knowledge redo var/wall_following.knowledge --teacher anna-phone
    """
    _require_one_of(lesson, teacher)
    planned = plan_redo(file, lesson, teacher, teacher=TEACHER)
    if not confirmed(planned, "redo", "standing again", runs, no_preview=no_preview, dry_run=dry_run, yes=yes):
        return
    apply_plan(planned, utc_now())
    for record in planned.lessons:
        say(f"{file}: redone: {format_lesson(record)}")
    for refusal in planned.stay:
        say(f"stays undone: {text_of(refusal)}")
    if teacher is not None:
        stay = f", {len(planned.stay)} do not" if planned.stay else ""
        say(f"{file}: {len(planned.lessons)} lessons of {teacher} redone{stay}")


def _require_one_of(lesson: str | None, teacher: str | None) -> None:
    if teacher is not None and lesson is not None:
        raise typer.BadParameter("give --lesson or --teacher, not both")
