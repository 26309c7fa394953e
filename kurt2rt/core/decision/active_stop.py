"""Active stop: why the robot stands until a teacher resumes, as a code with its fields."""

from typing import NamedTuple

from config.errors import TextCode
from kurt2rt.core.message_fields import Line


class StopReason(TextCode):
    """Code for why the robot stands until a teacher resumes, with its text."""

    SAID_STOP = ("said stop", "{name} said stop")
    """A teacher gave a stop."""
    LET_GO = ("let go", "{name} drove by hand and let go")
    """A teacher drove by hand and let go, or the press was lost."""
    BEHAVIOUR_OVER = ("behaviour over", "{name} is over")
    """A behaviour that the teacher ran has ended."""
    SESSION_OVER = ("session over", "the session {name!r} is over")
    NO_TEACHER = ("no teacher", "no teacher is there")
    """The robot drove and has no teacher now."""
    TEACHER_NOT_YET = ("teacher not yet", "{name} is not there yet")
    """The robot drove, and its new teacher has sent no sign of presence yet."""
    LINK_LOST = ("link lost", "lost the link to {name}")
    """The robot drove, and messages of its teacher ceased."""
    FALLS_BEHIND = (
        "falls behind",
        "the computer is too slow for {name} times real time; the simulation is back in real time",
    )
    """The same, because the computer was too slow for the speed of the simulation."""
    STARTED = ("started", "the robot program was started")
    """The robot program was started."""
    NEXT_RUN = ("next run", "a new run was begun")
    """The same program began a new run."""
    SENSOR_BROKEN = (
        "sensor broken",
        "its range sensor {name} is broken",
        "The sensors next to it stand in for it. Check its plug and its lens",
    )
    """An infra-red sensor was noticed to be dead, stuck or unplugged."""
    GUARD = ("guard", "the guard: {name}")
    """The guard keeps the robot stopped."""


class ActiveStop(NamedTuple):
    """Stop that lasts until a resume, with the name that its reason is about."""

    reason: StopReason
    name: Line = ""
    """Teacher, behaviour, session, sensor or the guard's code; empty if none is needed."""

    @property
    def teacher(self) -> str:
        """Name of the teacher who caused the stop or is missing; empty if the reason names none."""
        return self.name if self.reason in _OF_A_TEACHER else ""

    @property
    def is_automatic(self) -> bool:
        """Return whether the guard or a lost link caused the stop. A script may resume after these two only."""
        return self.reason in (StopReason.GUARD, StopReason.LINK_LOST, StopReason.FALLS_BEHIND)


_OF_A_TEACHER = (StopReason.SAID_STOP, StopReason.LET_GO, StopReason.TEACHER_NOT_YET, StopReason.LINK_LOST)

STARTED = ActiveStop(StopReason.STARTED)
NEXT_RUN = ActiveStop(StopReason.NEXT_RUN)
