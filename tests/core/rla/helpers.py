"""Teaching events in one line each."""

import pytest

from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.events import (
    ActionReplaced,
    ActionWithdrawn,
    InvalidEventError,
    LessonUndone,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    SessionBegun,
    SessionEnded,
    SituationNamed,
    TeachingEvent,
)
from kurt2rt.core.rla.rla import BASIC, Origin, Phase, Rla
from kurt2rt.core.rla.rla_system import RlaSystem


def refused_by(system: RlaSystem, event: TeachingEvent) -> InvalidEventError:
    """Return the error of an event that does not fit."""
    with pytest.raises(InvalidEventError) as caught:
        system.apply(event)
    return caught.value


def origin(command_id: str = "lesson-1", tick: int = 1) -> Origin:
    return Origin(command_id, "Ann", Phase.SUPERVISED, tick)


def created(
    rla_id: int,
    condition: Condition,
    action: str = "forward",
    radius: float | None = None,
    command_id: str | None = None,
    behaviour: str = "",
    level: str = BASIC,
) -> RlaCreated:
    taught = origin(command_id or f"lesson-{rla_id}", rla_id)
    return RlaCreated(Rla(rla_id, condition, action, radius, taught, behaviour, level))


def replaced(rla_id: int, action: str, instead_of: str, command_id: str | None = None) -> ActionReplaced:
    return ActionReplaced(rla_id, action, instead_of, origin(command_id or f"correction-{rla_id}", 1000 + rla_id))


def withdrawn(rla_id: int, instead_of: str = "forward", command_id: str | None = None) -> ActionWithdrawn:
    return ActionWithdrawn(rla_id, instead_of, origin(command_id or f"withdrawal-{rla_id}", 1500 + rla_id))


def deleted(rla_id: int, command_id: str | None = None) -> RlaDeleted:
    return RlaDeleted(rla_id, origin(command_id or f"deletion-{rla_id}", 2000 + rla_id))


def rewarded(rla_id: int, value: int = 1, command_id: str | None = None) -> RlaRewarded:
    return RlaRewarded(rla_id, value, 2990, origin(command_id or f"reward-{rla_id}", 3000 + rla_id))


def named(name: str, situation: tuple[float, ...], level: str = BASIC, command_id: str | None = None) -> SituationNamed:
    return SituationNamed(name, situation, level, origin(command_id or f"naming-{name}", 3500))


def undone(lesson: str) -> LessonUndone:
    return LessonUndone(lesson, origin(f"undo-{lesson}", 4000))


def session(lasted_ticks: int) -> tuple[SessionBegun, SessionEnded]:
    return SessionBegun("morning", origin("begin", 5000)), SessionEnded(lasted_ticks, origin("end", 5000))


def system_of(*events: TeachingEvent, radius: float = 5.0) -> RlaSystem:
    """Return a plane's system that was taught by events."""
    system = RlaSystem(2, radius)
    system.apply_all(events)
    return system
