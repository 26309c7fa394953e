"""Lesson result: outcome and event of a command that teaches, and what it was given about."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.outcome import CommandRefusedError, Field, Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import BASIC, Rla
from kurt2rt.core.rla.rla_system import RlaSystem


class LessonResult(NamedTuple):
    """Outcome of a command for its teacher, and the events by which it changes the knowledge."""

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


class LessonContext(NamedTuple):
    """Situation that a lesson is about, with its level and behaviour, and the RLA that answered there."""

    vector: NDArray[np.float64]
    """Situation of the level, shape (d,)."""
    behaviour: str
    """Behaviour that the lesson belongs to; empty if the level has a single one."""
    level: str
    drove: int | None
    """RLA that answered there; None if none did."""
    insert_radius_fraction: float
    """A correction farther than this share of R from the nearest condition inserts a new RLA, else it replaces."""
    touched: bool = False
    """True if the robot asked at a bumper: an answer corrects the RLA that pushed on."""


def require_action(action: str, repertoire: Iterable[str]) -> None:
    """Raise CommandRefusedError, which lists the actions, if the repertoire lacks `action`."""
    names = tuple(repertoire)
    if action not in names:
        raise CommandRefusedError(RefusalCode.NO_ACTION, action=action, known=names)


def require_behaviour(name: str, behaviours: Iterable[str]) -> None:
    """Raise CommandRefusedError, which lists the behaviours, if the task does not teach `name`."""
    names = tuple(behaviours)
    if name not in names:
        raise CommandRefusedError(RefusalCode.NO_BEHAVIOUR, behaviour=name, known=names)


def require_rla(rla_id: int, system: RlaSystem) -> Rla:
    """Return the RLA of an id. Raises CommandRefusedError if `system` has none."""
    rla = system.get(rla_id)
    if rla is None:
        raise CommandRefusedError(RefusalCode.NO_RLA, rla=rla_id)
    return rla
