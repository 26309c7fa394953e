"""`kurt2rt knowledge undo` and `redo`: a preview and a question before anything is changed."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from config.errors import ExitCode
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.knowledge.shared import TEACHER, KnowledgeFile, change_lines, format_lesson
from kurt2rt.cli.options import refuse_if
from kurt2rt.cli.progress import job_bars
from kurt2rt.cli.tables import say
from kurt2rt.core.outcome_text import text_of
from kurt2rt.knowledge.journal.writer import utc_now
from kurt2rt.knowledge.versions.editing import require_no_robot
from kurt2rt.knowledge.versions.undo import UndoPlan, apply_plan, plan_redo, plan_undo
from kurt2rt.runs.replay.undo_preview import preview, preview_on_newest
from kurt2rt.service.settings import load_service


@dataclass(frozen=True, slots=True)
class _Options:
    file: KnowledgeFile
    lesson: Annotated[
        str | None,
        typer.Option(
            help="Id of the lesson, hold or merge, as lessons and merge show it. Default: the newest, or for redo the "
            "one undone last."
        ),
    ] = None
    teacher: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="All lessons of this teacher, or for redo all that were undone; critic: the robot's own critic.",
        ),
    ] = None
    runs: Annotated[
        Path | None,
        typer.Option(
            help="Replay all runs of this folder, or this one run, to preview. Default: the last ten minutes of the "
            "newest run in the folder that the settings name."
        ),
    ] = None
    no_preview: Annotated[bool, typer.Option("--no-preview", help="Do it without a replay and without a question.")] = (
        False
    )
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only show what it would change.")] = False
    yes: Annotated[bool, typer.Option("--yes", "-y", help="Do not ask. Without a terminal it never asks.")] = False


@takes_options(_Options)
def undo(options: _Options) -> None:
    """Undo a lesson, a merge, or all of one teacher: what it changed is as before.

    It first replays the newest recorded run of this knowledge, and shows the
    decisions that differ without the lesson. At a terminal it then asks.

    For example:

        kurt2rt knowledge undo var/wall_following.knowledge
        kurt2rt knowledge undo var/wall_following.knowledge --teacher anna-phone --dry-run
    """
    _require_one_of(options)
    planned = plan_undo(options.file, options.lesson, options.teacher, teacher=TEACHER)
    _carry_out(planned, options, "undo", "undone", "undone")


@takes_options(_Options)
def redo(options: _Options) -> None:
    """Redo a lesson that was undone, or all of one teacher, if its RLA is as the lesson found it.

    It first shows the decisions that differ with the lesson, and asks, as undo.

    For example:

        kurt2rt knowledge redo var/wall_following.knowledge
        kurt2rt knowledge redo var/wall_following.knowledge --teacher anna-phone
    """
    _require_one_of(options)
    planned = plan_redo(options.file, options.lesson, options.teacher, teacher=TEACHER)
    _carry_out(planned, options, "redo", "standing again", "redone")


def _require_one_of(options: _Options) -> None:
    both = options.teacher is not None and options.lesson is not None
    refuse_if(both, "give one of them, not both", "--lesson, --teacher")


def _carry_out(planned: UndoPlan, options: _Options, what: str, become: str, done: str) -> None:
    """Show what the plan would change, ask, and write it unless --dry-run or the user forbid it.

    Raises KnowledgeError if a robot runs on the file, before anything is replayed; typer.Exit if the user says no.
    """
    file, dry_run = options.file, options.dry_run
    # sys.stdin is None if standard input was closed.
    asks = not (dry_run or options.yes or options.no_preview) and sys.stdin is not None and sys.stdin.isatty()
    if not dry_run and not options.no_preview:
        require_no_robot(planned.path)
    if dry_run or asks:
        for record in planned.lessons:
            say(f"{planned.path}: would be {become}: {format_lesson(record)}")
        for refusal in planned.stay:
            say(f"would stay as it is: {text_of(refusal)}")
    if not options.no_preview:
        _show(planned, options.runs)
    if dry_run:
        say("nothing was changed: --dry-run")
        return
    if asks and not typer.confirm(_question(planned, what), err=True):
        say("nothing was changed")
        raise typer.Exit(ExitCode.FAILED)
    apply_plan(planned, utc_now())
    for record in planned.lessons:
        say(f"{file}: {done}: {format_lesson(record)}")
    for refusal in planned.stay:
        say(f"stays as it is: {text_of(refusal)}")
    if options.teacher is not None:
        stay = f", {len(planned.stay)} are not" if planned.stay else ""
        say(f"{file}: {len(planned.lessons)} lessons of {options.teacher} {done}{stay}")


def _question(planned: UndoPlan, what: str) -> str:
    if len(planned.lessons) == 1:
        return f"{what.capitalize()} lesson {planned.lessons[0].event.origin.command_id}?"
    return f"{what.capitalize()} these {len(planned.lessons)} lessons?"


def _show(planned: UndoPlan, runs: Path | None) -> None:
    recordings = runs or Path(load_service().recordings)
    try_on = preview if runs else preview_on_newest
    with job_bars(transient=True) as report:
        shown = try_on(planned, recordings, report)
    for tried in shown.runs:
        for line in change_lines(tried.run, tried.found, tried.from_s):
            say(line)
    for note in shown.notes:
        say(f"not tried: {note}")
    if not shown.runs and not shown.notes:
        say(f"not tried: {recordings} holds no recorded run of such knowledge")
