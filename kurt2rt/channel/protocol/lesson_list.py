"""Newest lessons and named situations, as the robot tells its teachers."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from kurt2rt.channel.protocol.limits import MOST_CONTRADICTIONS, MOST_LESSONS, MOST_SITUATIONS
from kurt2rt.core.teaching.message_fields import LARGEST_NUMBER, LONGEST_TEXT, Flag, Int, ListOf, Row, Text, WireError

_LINES = ListOf(
    Row((Text(128), Text(512), Text(128), Int(1, 5), Int(0, LARGEST_NUMBER), Text(64), Flag())),
    most=MOST_LESSONS,
)
_MOST_ACTIONS = 8
_AGAINST = ListOf(
    Row(
        (
            Text(128),
            Text(128),
            Int(1, LARGEST_NUMBER),
            Text(LONGEST_TEXT),
            Int(1, LARGEST_NUMBER),
            ListOf(Text(LONGEST_TEXT), most=_MOST_ACTIONS),
        )
    ),
    most=MOST_CONTRADICTIONS,
)
_SITUATIONS = ListOf(Text(LONGEST_TEXT, least=1), most=MOST_SITUATIONS)


class Contradicting(NamedTuple):
    """Lesson whose RLA has an action of another kind than its five nearest neighbours, as after a slip."""

    command_id: str
    """Name in the journal, to be given to `undo`: of the one lesson, also if a hold gave it."""
    rla: int
    action: str
    nearest: int
    """RLA nearest to it."""
    actions: tuple[str, ...]
    """Actions of the five nearest, each once."""


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
    against: tuple[Contradicting, ...] = ()
    """Its lessons that contradict their neighbours."""


def lesson_lines_of(body: Mapping[str, Any]) -> tuple[LessonLine, ...]:
    """Return the lessons in a decoded body, newest first. Raises WireError."""
    against: dict[str, list[Contradicting]] = {}
    for listed_as, *row in _AGAINST("against", _entry(body, "against")):
        against.setdefault(listed_as, []).append(Contradicting(*row))
    lines = (LessonLine(*each) for each in _LINES("lessons", _entry(body, "lessons")))
    return tuple(each._replace(against=tuple(against.get(each.command_id, ()))) for each in lines)


def situations_of(body: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the names of situations in a decoded body. Raises WireError."""
    names: tuple[str, ...] = _SITUATIONS("situations", _entry(body, "situations"))
    return names


def _entry(body: Mapping[str, Any], key: str) -> object:
    if key not in body:
        raise WireError(f"the robot's answer has no {key}")
    return body[key]
