"""Preview and confirmation of an undo or redo, before anything is changed."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from config.errors import ExitCode
from kurt2rt.cli.knowledge.shared import replaying, say
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.knowledge.versions.editing import require_no_robot
from kurt2rt.knowledge.versions.undo import UndoPlan
from kurt2rt.runs.replay.trial import format_answer
from kurt2rt.runs.replay.undo_preview import TrialResult, preview, preview_on_newest
from kurt2rt.service.settings import load_service

Runs = Annotated[
    Path | None,
    typer.Option(
        help="Replay all runs of this folder, or this one run, to preview. Default: the last ten minutes of the newest "
        "run in the folder that the settings name."
    ),
]
NoPreview = Annotated[bool, typer.Option("--no-preview", help="Do it without a replay and without a question.")]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Only show what it would change.")]
Yes = Annotated[bool, typer.Option("--yes", "-y", help="Do not ask. Without a terminal it never asks.")]

_MOST_STRETCHES = 8
"""Number of stretches shown of each run, the longest."""


def confirmed(
    planned: UndoPlan, what: str, become: str, runs: Path | None, *, no_preview: bool, dry_run: bool, yes: bool
) -> bool:
    """Show what the plan would change; return whether to write it, False with --dry-run.

    Args:
        planned: the plan.
        what: undo or redo.
        become: state of the lessons after it.
        runs: folder of recorded runs, or one run, to replay; None: the newest run of the service.
        no_preview: replay nothing, ask nothing.
        dry_run: only show.
        yes: do not ask.

    Raises:
        KnowledgeError: a robot runs on the file; raised before anything is replayed.
        SettingsError: the service's settings cannot be loaded.
        typer.Exit: code 1, the user says no.
    """
    # sys.stdin is None if standard input was closed.
    asks = not (dry_run or yes or no_preview) and sys.stdin is not None and sys.stdin.isatty()
    if not dry_run and not no_preview:
        require_no_robot(planned.path)
    if dry_run or asks:
        for record in planned.lessons:
            say(f"{planned.path}: would be {become}: {format_lesson(record)}")
        for refusal in planned.stay:
            say(f"would stay as it is: {text_of(refusal)}")
    if not no_preview:
        _show(planned, runs)
    if dry_run:
        say("nothing was changed: --dry-run")
        return False
    if asks and not typer.confirm(_question(planned, what), err=True):
        say("nothing was changed")
        raise typer.Exit(ExitCode.FAILED)
    return True


def format_lesson(record: LessonRecord) -> str:
    """Return a lesson in a few words, with its command id."""
    origin = record.event.origin
    return f"{record.text} (lesson {origin.command_id} by {origin.teacher})"


def _question(planned: UndoPlan, what: str) -> str:
    if len(planned.lessons) == 1:
        return f"{what.capitalize()} lesson {planned.lessons[0].event.origin.command_id}?"
    return f"{what.capitalize()} these {len(planned.lessons)} lessons?"


def _show(planned: UndoPlan, runs: Path | None) -> None:
    recordings = runs or Path(load_service().recordings)
    try_on = preview if runs else preview_on_newest
    with replaying() as report:
        shown = try_on(planned, recordings, report)
    for tried in shown.runs:
        for line in _changes(tried):
            say(line)
    for note in shown.notes:
        say(f"not tried: {note}")
    if not shown.runs and not shown.notes:
        say(f"not tried: {recordings} holds no recorded run of such knowledge")


def _changes(tried: TrialResult) -> Iterator[str]:
    found = tried.found
    decisions = f"{found.decided} decisions"
    if tried.from_s:
        decisions += f" from {tried.from_s:.0f} s on"
    if found.same:
        yield f"{tried.run}: not one of {decisions} would have been another"
        return
    counts = (
        (found.other_action, "another action"),
        (found.would_ask, "ask where it drove"),
        (found.would_drive, "drive where it asked"),
        (found.mid_otherwise, "another way"),
    )
    kinds = ", ".join(f"{count} times {what}" for count, what in counts if count)
    yield f"{tried.run}: of {decisions}: {kinds}; the longest:"
    longest = sorted(found.stretches, key=lambda each: -each.ticks)[:_MOST_STRETCHES]
    for each in sorted(longest, key=lambda each: each.from_s):
        change = f"{format_answer(each.would_be)}, instead of {format_answer(each.was)}"
        yield f"  {each.from_s:7.2f} to {each.to_s:7.2f} s  {change}"
