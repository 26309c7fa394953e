"""Inbox: queue of commands for the next tick."""

from collections import deque
from collections.abc import Iterable

from kurt2rt.core.teaching.commands import Stop
from kurt2rt.core.teaching.system_events import Input, PairingRenewed, RobotRepositioned, SpeedChanged


class InboxFullError(RuntimeError):
    """The inbox is full; the command was not queued."""


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
        if len(self._waiting) >= self._capacity and not isinstance(command, Stop):
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
