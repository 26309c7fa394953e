"""One rule-like association, and the teaching acts that make, change and end it."""

from dataclasses import dataclass
from enum import IntEnum


class Phase(IntEnum):
    """The paper's five training phases (section IV)."""

    SUPERVISED = 1
    CORRECTIONS = 2
    REINFORCEMENT = 3
    CRITIC = 4
    AUTONOMOUS = 5


Condition = tuple[float, ...]
"""A point in feature space, one float64 per feature of the situation definition."""


@dataclass(frozen=True, slots=True)
class Origin:
    """Who taught something, and when on the robot's own clock."""

    command_id: str
    """Name of the teacher's command; a command that comes twice counts once."""
    teacher: str
    phase: Phase
    tick: int
    """Tick of the run in which the command acted."""


def rla_title(rla_id: int, behaviour: str) -> str:
    """How an RLA is spoken of: RLA 17, or RLA 17 of turn_left where the taught behaviour has a name."""
    return f"RLA {rla_id} of {behaviour}" if behaviour else f"RLA {rla_id}"


@dataclass(frozen=True, slots=True)
class Rla:
    """A rule-like association (paper, III.A). The expectation is left blank until the robot has used it."""

    rla_id: int
    """1, 2, 3 ... in the order of teaching; of two equally near RLAs the older, smaller one wins."""
    condition: Condition
    action: str
    """A name in the repertoire."""
    radius: float | None
    """Own confidence radius; None: that of the system."""
    origin: Origin
    """Who taught the action it has now, and when."""
    behaviour: str = ""
    """The taught behaviour it belongs to: it answers only while that one is wanted. Empty where a task has only one."""

    @property
    def title(self) -> str:
        """How it is spoken of."""
        return rla_title(self.rla_id, self.behaviour)


@dataclass(frozen=True, slots=True)
class RlaCreated:
    """The teacher answered a situation: a new RLA stands there (phase 1, or inserted in phase 2)."""

    rla: Rla

    @property
    def origin(self) -> Origin:
        """Who taught it, and when."""
        return self.rla.origin


@dataclass(frozen=True, slots=True)
class ActionReplaced:
    """The teacher corrected an RLA: it has another action from now on (phase 2)."""

    rla_id: int
    action: str
    instead_of: str
    origin: Origin


@dataclass(frozen=True, slots=True)
class RlaDeleted:
    """The teacher deleted an RLA while the robot was running (phase 2)."""

    rla_id: int
    origin: Origin


@dataclass(frozen=True, slots=True)
class RlaRewarded:
    """The teacher praised or blamed what an RLA decided (phase 3)."""

    rla_id: int
    value: int
    """+1 reward, -1 punishment."""
    decided_at_tick: int
    """Tick of the decision that was meant."""
    origin: Origin


@dataclass(frozen=True, slots=True)
class LessonUndone:
    """The teacher took one lesson back: what it made, changed, ended or rewarded is as before it."""

    lesson: str
    """Command id of the lesson."""
    origin: Origin


@dataclass(frozen=True, slots=True)
class SessionBegun:
    """A teacher began to teach; changes no RLA."""

    name: str
    origin: Origin


@dataclass(frozen=True, slots=True)
class SessionEnded:
    """A teacher stopped teaching; changes no RLA."""

    lasted_ticks: int
    """Teaching time, waits included."""
    origin: Origin


Lesson = RlaCreated | ActionReplaced | RlaDeleted | RlaRewarded
"""A teaching act that can be undone."""

TeachingEvent = Lesson | LessonUndone | SessionBegun | SessionEnded
"""What the knowledge journal holds; the RLA system is the fold of these."""
