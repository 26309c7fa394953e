"""Newest lessons and named situations, as the robot tells its teachers."""

from typing import Annotated, NamedTuple

from kurt2rt.channel.protocol.limits import MOST_CONTRADICTIONS, MOST_LESSONS, MOST_SITUATIONS
from kurt2rt.channel.protocol.schema import Codec
from kurt2rt.core.message_fields import Int, Line, Name, Number, Title, Truth, UpTo, Word


class Contradicting(NamedTuple):
    """Lesson whose RLA has an action of another kind than its five nearest neighbours, as after a slip."""

    command_id: Title
    """Name in the journal, to be given to `undo`: of the one lesson, also if a hold gave it."""
    rla: Number
    action: Word
    nearest: Number
    """RLA nearest to it."""
    actions: Annotated[tuple[Word, ...], UpTo(8)]
    """Actions of the five nearest, each once."""


class LessonLine(NamedTuple):
    """Lesson as the robot lists it for its teachers, newest first, with whether it stands or was undone."""

    command_id: Title
    """Name in the journal, to be given to `undo`."""
    text: Line
    """The lesson in words."""
    teacher: Title
    phase: Annotated[int, Int(1, 5)]
    tick: Number
    """Tick of the run in which it was taught."""
    stamp: Word
    """Time when it became durable, UTC; empty before."""
    undone: Truth
    against: Annotated[tuple[Contradicting, ...], UpTo(MOST_CONTRADICTIONS)] = ()
    """Its lessons that contradict their neighbours."""


LESSONS = Codec[tuple[LessonLine, ...]]("lessons", Annotated[tuple[LessonLine, ...], UpTo(MOST_LESSONS)])
SITUATIONS = Codec[tuple[str, ...]]("situations", Annotated[tuple[Name, ...], UpTo(MOST_SITUATIONS)])
