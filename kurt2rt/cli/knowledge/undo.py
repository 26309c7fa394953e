"""`kurt2rt knowledge undo` and `redo`."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.care.preview import Tried, preview_undo
from kurt2rt.care.trial import said
from kurt2rt.cli.knowledge.shared import TEACHER, KnowledgeFile, Recordings, replaying, say
from kurt2rt.knowledge.undo import redo_lesson, redo_lessons_of, undo_lesson, undo_lessons_of
from kurt2rt.knowledge.writer import utc_now
from kurt2rt.rla.lesson_book import LessonRecord

_STRETCHES = 8
"""Of each run so many are told, the longest."""


def undo(
    file: KnowledgeFile,
    lesson: Annotated[
        str | None,
        typer.Option(help="Id of the lesson, as kurt2rt knowledge lessons shows it; else the last one that stands."),
    ] = None,
    of: Annotated[
        str | None,
        typer.Option(help="All lessons of this teacher that stand, newest first; the critic's are of: critic."),
    ] = None,
    preview: Annotated[
        bool, typer.Option("--preview", help="Change nothing: tell what it would have changed in recorded runs.")
    ] = False,
    recordings: Recordings = Path("var/runs"),
) -> None:
    """Take a lesson back, or all of one teacher: what it made, changed, ended or rewarded is as it was before."""
    if of is not None and lesson is not None:
        raise typer.BadParameter("give --lesson or --of, not both")
    if preview:
        _preview(file, lesson, of, recordings)
        return
    if of is None:
        undone: tuple[LessonRecord, ...] = (undo_lesson(file, lesson, teacher=TEACHER, stamp=utc_now()),)
    else:
        undone = undo_lessons_of(file, of, teacher=TEACHER, stamp=utc_now())
    for record in undone:
        say(f"{file}: undone: {_told(record)}")
    if of is not None:
        say(f"{file}: {len(undone)} lessons of {of} undone")


def redo(
    file: KnowledgeFile,
    lesson: Annotated[
        str | None,
        typer.Option(help="Id of the lesson, as kurt2rt knowledge lessons shows it; else the one undone last."),
    ] = None,
    of: Annotated[
        str | None, typer.Option(help="All lessons of this teacher that were undone, the one undone last first.")
    ] = None,
) -> None:
    """Let a lesson stand again that was undone, or all of one teacher, where its RLA is as the lesson found it."""
    if of is not None and lesson is not None:
        raise typer.BadParameter("give --lesson or --of, not both")
    if of is None:
        say(f"{file}: stands again: {_told(redo_lesson(file, lesson, teacher=TEACHER, stamp=utc_now()))}")
        return
    redone, reasons = redo_lessons_of(file, of, teacher=TEACHER, stamp=utc_now())
    for record in redone:
        say(f"{file}: stands again: {_told(record)}")
    for reason in reasons:
        say(f"stays undone: {reason}")
    say(f"{file}: {len(redone)} lessons of {of} stand again" + (f", {len(reasons)} do not" if reasons else ""))


def _preview(file: Path, lesson: str | None, of: str | None, recordings: Path) -> None:
    with replaying() as report:
        shown = preview_undo(file, lesson, of, recordings, report)
    for record in shown.lessons:
        say(f"{file}: would be undone: {_told(record)}")
    for tried in shown.runs:
        for line in _changes(tried):
            say(line)
    for note in shown.notes:
        say(f"not tried: {note}")
    say("nothing was changed")


def _changes(tried: Tried) -> Iterator[str]:
    found = tried.found
    if found.same:
        yield f"{tried.run}: not one of {found.decided} decisions would have been another"
        return
    counts = (
        (found.other_action, "another action"),
        (found.would_ask, "ask where it drove"),
        (found.would_drive, "drive where it asked"),
        (found.mid_otherwise, "another way"),
    )
    kinds = ", ".join(f"{count} times {what}" for count, what in counts if count)
    yield f"{tried.run}: of {found.decided} decisions: {kinds}; the longest:"
    longest = sorted(found.stretches, key=lambda each: -each.ticks)[:_STRETCHES]
    for each in sorted(longest, key=lambda each: each.from_s):
        yield f"  {each.from_s:7.2f} to {each.to_s:7.2f} s  {said(each.would_be)}, instead of {said(each.was)}"


def _told(record: LessonRecord) -> str:
    origin = record.event.origin
    return f"{record.text} (lesson {origin.command_id} by {origin.teacher})"
