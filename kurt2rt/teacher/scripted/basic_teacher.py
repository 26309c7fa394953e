"""Scripted teachers of the basic level: their view of the robot, and the commands that all of them give."""

from abc import ABC, abstractmethod
from typing import NamedTuple, Protocol

from kurt2rt.core.rla.rla import BASIC, SCRIPTED, Phase
from kurt2rt.core.teaching.commands import Command, Pursue, Resume, SetPhase
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.teacher.scripted.press_times import PressTimes


class TeacherView(NamedTuple):
    """State of the robot as a scripted teacher sees it, from a tick record, the channel or a batch."""

    asking: bool
    """Its basic level asks."""
    driving: bool
    action: str | None
    infrared_counts: tuple[int, ...]
    behaviour: str = ""
    """Taught behaviour that the robot follows."""
    tick: int = 0
    """Tick of the state."""
    touching: bool = False
    """The robot touches something."""


def view_of_tick(record: TickRecord, *, touching: bool = False) -> TeacherView:
    """Return the teacher's view of a tick.

    Args:
        record: of the tick.
        touching: whether its side touches something, which no bumper tells but a person in the room sees.
    """
    decision = record.decision
    return TeacherView(
        asking=decision.asking and decision.asks_at == BASIC,
        driving=decision.driving,
        action=decision.action,
        infrared_counts=record.readings.infrared_counts,
        behaviour=record.behaviour,
        tick=record.tick,
        touching=touching or record.readings.bumpers != 0,
    )


class Ahead(Protocol):
    """Ticks of a compiled robot that were driven in advance, of which a teacher skips the uneventful ones."""

    @property
    def ticks(self) -> int:
        """Number of ticks whose states are known in advance."""
        ...

    @property
    def until_question(self) -> int:
        """Number of ticks before the first in which the basic level asks; all without one."""
        ...

    @property
    def until_difference(self) -> int:
        """Number of ticks before the first in which it asks or does another action than the policy's."""
        ...

    @property
    def until_change(self) -> int:
        """Number of ticks before the first with another action, or another right action, than in the tick before."""
        ...


class BasicTeacher(ABC):
    """Base of scripted teachers of the basic level, which see states and give a person's commands."""

    may_be_late = False
    """True if the robot may refuse a command because it comes too late."""
    times: PressTimes
    """Times of this teacher's presses to the mid level, and of rewards."""

    def __init__(self, session: str) -> None:
        """Create a teacher in phase 1; `session` is the prefix of command ids, unique on the same knowledge."""
        self._session = session
        self._command_count = 0
        self.phase = Phase.SUPERVISED

    @abstractmethod
    def update(self, view: TeacherView, ticks: int = 1) -> Command | None:
        """Process a view that is `ticks` later than the last one; return the teacher's command, None without one."""

    @abstractmethod
    def skip(self, ahead: Ahead) -> int:
        """Let coming ticks pass in which this teacher does nothing; return how many, and call `update` for the next.

        So the teacher of a robot that is simulated in stretches has no work in most ticks.
        """

    @property
    def command_due(self) -> int | None:
        """Tick, counted from the begin of the teaching, in which a command is under way to arrive; None without one."""
        return None

    def begin_phase(self, phase: Phase) -> Command:
        """Enter a phase; return the command that the robot needs for it."""
        self.phase = phase
        return SetPhase(self._next_id(), SCRIPTED, phase)

    def select_behaviour(self, behaviour: str) -> Command:
        """Return the command that selects a taught behaviour."""
        return Pursue(self._next_id(), SCRIPTED, behaviour)

    def resume(self) -> Command:
        """Return the command that lets the robot drive again after a stop."""
        return Resume(self._next_id(), SCRIPTED)

    def _next_id(self) -> str:
        self._command_count += 1
        return f"{self._session}-{self._command_count}"
