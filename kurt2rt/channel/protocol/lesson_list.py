"""Newest lessons and named situations, as the robot tells its teachers."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from kurt2rt.channel.protocol.limits import LARGEST_NUMBER, LONGEST_TEXT, MOST_LESSONS, MOST_SITUATIONS
from kurt2rt.channel.protocol.schema import Flag, Int, ManyOf, Row, Text, WireError

_LINES = ManyOf(
    Row((Text(128), Text(512), Text(128), Int(1, 5), Int(0, LARGEST_NUMBER), Text(64), Flag())),
    most=MOST_LESSONS,
)
_SITUATIONS = ManyOf(Text(LONGEST_TEXT, least=1), most=MOST_SITUATIONS)


class LessonLine(NamedTuple):
    """Lesson in the list, with its present state."""

    command_id: str
    """Name in the journal, to be given to `undo`."""
    text: str
    """The lesson in words."""
    teacher: str
    phase: int
    tick: int
    """Tick of the run in which it was taught."""
    stamp: str
    """Time when it became durable, UTC; empty before."""
    undone: bool


def lesson_lines_of(body: Mapping[str, Any]) -> tuple[LessonLine, ...]:
    """Return the lessons in a decoded body, newest first. Raises WireError."""
    return tuple(LessonLine(*each) for each in _LINES("lessons", _entry(body, "lessons")))


def situations_of(body: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the names of situations in a decoded body. Raises WireError."""
    names: tuple[str, ...] = _SITUATIONS("situations", _entry(body, "situations"))
    return names


def _entry(body: Mapping[str, Any], key: str) -> object:
    if key not in body:
        raise WireError(f"the robot's answer has no {key}")
    return body[key]
