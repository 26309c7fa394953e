"""Inbox: queue of commands and events of the program for the next tick."""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

from hal import points
from kurt2rt.core.teaching.commands import Command, Stop


@dataclass(frozen=True, slots=True)
class PairingRenewed:
    """New or removed keys of a teacher's device: its press ids start again."""

    teacher: str


@dataclass(frozen=True, slots=True)
class RobotRepositioned:
    """New place of the robot, which a hand set down elsewhere; its history there is empty."""


@dataclass(frozen=True, slots=True)
class SpeedChanged:
    """New speed of a simulation: robot time passes `times` as fast as real time."""

    times: int
    falls_behind: bool = False
    """True if the computer was too slow for the speed before, so that its teacher's messages came too late."""


SystemEvent = PairingRenewed | RobotRepositioned | SpeedChanged

Input = Command | SystemEvent
"""Message that a tick takes from the inbox."""


class InboxFullError(RuntimeError):
    """Command that was not queued, because the inbox of the next tick is full."""


class TeacherInbox:
    """Bounded queue that any thread fills and the tick empties."""

    def __init__(self, capacity: int = 256) -> None:
        self._waiting: deque[Input] = deque()
        self._capacity = capacity

    def put(self, command: Input) -> None:
        """Queue a message for the next tick. Raises InboxFullError; a stop or a system event is always queued."""
        if isinstance(command, PairingRenewed | RobotRepositioned | SpeedChanged):
            self._waiting.appendleft(command)  # it happened before the waiting commands act
            return
        is_full = len(self._waiting) >= self._capacity or points.happens("the inbox is full")
        if is_full and not isinstance(command, Stop):
            raise InboxFullError(
                f"{self._capacity} commands wait already; is the robot's loop running? Send it again later"
            )
        self._waiting.append(command)

    def replace_pending(self, commands: Iterable[Input]) -> None:
        """Replace all waiting messages, so that the next tick takes exactly these, as a recorded tick did."""
        self._waiting = deque(commands)

    @property
    def is_empty(self) -> bool:
        """Return whether no message waits."""
        return not self._waiting

    def pop_all(self) -> tuple[Input, ...]:
        """Return all waiting messages in order of arrival; never block."""
        if not self._waiting:
            return ()
        # One at a time, because another thread may append meanwhile; its message is taken as well.
        taken = []
        while self._waiting:
            taken.append(self._waiting.popleft())
        return tuple(taken)
