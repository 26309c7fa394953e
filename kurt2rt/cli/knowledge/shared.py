"""Options and output shared by the commands of `kurt2rt knowledge`."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.runs.replay.counterfactual import Counterfactual
from kurt2rt.runs.replay.trial import format_answer

WIDE = 140
_MOST_STRETCHES = 8
"""Number of stretches shown of each run, the longest."""
TEACHER = "command line"
"""Teacher of the lessons that these commands write."""

KnowledgeFile = Annotated[Path, typer.Argument(help="Knowledge file, as kurt2rt train or kurt2rt run leaves it.")]


def format_lesson(record: LessonRecord) -> str:
    """Return a lesson in a few words, with its command id."""
    origin = record.event.origin
    return f"{record.text} (lesson {origin.command_id} by {origin.teacher})"


def change_lines(run: str, found: Counterfactual, from_s: float = 0.0) -> Iterator[str]:
    """Yield lines about the decisions of a run that other knowledge would change; `from_s`: where the replay began."""
    decisions = f"{found.decided} decisions"
    if from_s:
        decisions += f" from {from_s:.0f} s on"
    if found.same:
        yield f"{run}: not one of {decisions} would have been another"
        return
    counts = (
        (found.other_action, "another action"),
        (found.would_ask, "ask where it drove"),
        (found.would_drive, "drive where it asked"),
        (found.mid_otherwise, "another way"),
    )
    kinds = ", ".join(f"{count} times {what}" for count, what in counts if count)
    yield f"{run}: of {decisions}: {kinds}; the longest:"
    longest = sorted(found.stretches, key=lambda each: -each.ticks)[:_MOST_STRETCHES]
    for each in sorted(longest, key=lambda each: each.from_s):
        change = f"{format_answer(each.would_be)}, instead of {format_answer(each.was)}"
        yield f"  {each.from_s:7.2f} to {each.to_s:7.2f} s  {change}"
