"""Lesson result: outcome and event of a command that teaches."""

from typing import NamedTuple

from kurt2rt.core.outcome import Field, Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import BASIC, Rla


class LessonResult(NamedTuple):
    """Outcome of a lesson and the event that makes it."""

    outcome: Outcome
    event: TeachingEvent | None = None
    """Change of the knowledge, by the command's own id; None if it changes nothing."""
    before: tuple[TeachingEvent, ...] = ()
    """Changes by derived ids, applied before `event`."""


def rla_outcome(code: ResultCode | RefusalCode, rla: Rla, **fields: Field) -> Outcome:
    """Return an outcome with an RLA's id, and with its behaviour and level if they are not the default.

    `fields`: further fields of the code's text.
    """
    named: dict[str, Field] = {"rla": rla.rla_id}
    if rla.behaviour:
        named["behaviour"] = rla.behaviour
    if rla.level != BASIC:
        named["level"] = rla.level
    return Outcome(code, {**named, **fields})
