"""One lesson in the list of a teacher's device."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from kurt2rt.channel.protocol.requests import LARGEST_NUMBER, MOST_LESSONS
from kurt2rt.channel.protocol.schema import Flag, Int, ManyOf, Row, Text, WireError

_LINES = ManyOf(
    Row((Text(128), Text(512), Text(128), Int(1, 5), Int(0, LARGEST_NUMBER), Text(64), Flag())),
    most=MOST_LESSONS,
)


class LessonLine(NamedTuple):
    """A lesson, and what has become of it."""

    command_id: str
    """Its name in the journal, to be given to `undo`."""
    text: str
    """The lesson in words."""
    teacher: str
    phase: int
    tick: int
    """Of the run in which it was taught."""
    stamp: str
    """When it became durable, UTC; empty before."""
    undone: bool


def lesson_lines_of(body: Mapping[str, Any]) -> tuple[LessonLine, ...]:
    """The list in a decoded body, newest first. Raises WireError."""
    if "lessons" not in body:
        raise WireError("the robot's answer has no lessons")
    return tuple(LessonLine(*each) for each in _LINES("lessons", body["lessons"]))
