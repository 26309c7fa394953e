"""Result of a command that is about the knowledge."""

from typing import NamedTuple

from kurt2rt.core.outcome import Field, Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.rla import BASIC, Rla, TeachingEvent


class LessonResult(NamedTuple):
    """What a lesson comes to."""

    outcome: Outcome
    event: TeachingEvent | None = None
    """Changes the knowledge so; None if nothing has to be changed."""


def rla_outcome(code: ResultCode | RefusalCode, rla: Rla, **fields: Field) -> Outcome:
    """Return an outcome that names an RLA: its id, and its behaviour and level if they are not the usual ones."""
    named: dict[str, Field] = {"rla": rla.rla_id}
    if rla.behaviour:
        named["behaviour"] = rla.behaviour
    if rla.level != BASIC:
        named["level"] = rla.level
    return Outcome(code, {**named, **fields})
