"""Stops that hold until a teacher says Go, as codes with their fields."""

from enum import StrEnum
from typing import NamedTuple


class StopReason(StrEnum):
    """Code for why the robot stands until Go."""

    SAID_STOP = "said stop"
    """A teacher said stop."""
    LET_GO = "let go"
    """A teacher drove by hand and let go, or the press was lost."""
    BEHAVIOUR_OVER = "behaviour over"
    """A behaviour that the teacher ran has ended."""
    SESSION_OVER = "session over"
    NO_TEACHER = "no teacher"
    """The robot drove, and has no teacher any more."""
    TEACHER_NOT_YET = "teacher not yet"
    """The robot drove, and its new teacher has not looked at it yet."""
    LINK_LOST = "link lost"
    """The robot drove, and its teacher is not heard any more."""
    STARTED = "started"
    """The robot program was started."""
    NEXT_RUN = "next run"
    """A new run was begun in the same program."""
    GUARD = "guard"
    """The guard keeps the robot stopped."""
    OTHER = "other"
    """A reason of another version of kurt2rt, known by its sentence only."""


class ActiveStop(NamedTuple):
    """A stop that holds, and the name that its reason is about."""

    reason: StopReason
    name: str = ""
    """Teacher, behaviour, session or the guard's code; of OTHER the sentence; empty if the reason needs no name."""

    @property
    def teacher(self) -> str:
        """Name of the teacher who caused the stop or is missing; empty if the reason names none."""
        return self.name if self.reason in _OF_A_TEACHER else ""

    @property
    def is_automatic(self) -> bool:
        """Whether the robot stopped itself, so that a script may resume, unlike after a person's stop."""
        return self.reason in (StopReason.GUARD, StopReason.LINK_LOST)


_OF_A_TEACHER = (StopReason.SAID_STOP, StopReason.LET_GO, StopReason.TEACHER_NOT_YET, StopReason.LINK_LOST)

STARTED = ActiveStop(StopReason.STARTED)
NEXT_RUN = ActiveStop(StopReason.NEXT_RUN)
