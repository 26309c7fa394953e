"""Where commands wait for the next tick."""

from collections import deque
from collections.abc import Iterable

from kurt2rt.core.teaching.commands import Stop
from kurt2rt.core.teaching.system_events import Input, PairingRenewed, RobotRepositioned, SpeedChanged


class InboxFullError(RuntimeError):
    """More commands wait than a teacher can mean; nothing was taken in."""


class TeacherInbox:
    """A bounded queue that any thread may fill and the tick empties."""

    def __init__(self, capacity: int = 256) -> None:
        self._waiting: deque[Input] = deque()
        self._capacity = capacity

    def put(self, command: Input) -> None:
        """Hand a command to the next tick. Raises InboxFullError; a stop, and what has happened, is always taken."""
        if isinstance(command, PairingRenewed | RobotRepositioned | SpeedChanged):
            self._waiting.appendleft(command)  # it has happened, and the commands that wait have not
            return
        if len(self._waiting) >= self._capacity and not isinstance(command, Stop):
            raise InboxFullError(
                f"{self._capacity} commands wait already; is the robot's loop running? Send it again later"
            )
        self._waiting.append(command)

    def replace_pending(self, commands: Iterable[Input]) -> None:
        """Have the next tick take exactly these, in this order, as a recorded one did."""
        self._waiting = deque(commands)

    def pop_all(self) -> tuple[Input, ...]:
        """All commands that wait, in the order they came; never blocks."""
        if not self._waiting:
            return ()
        # One at a time: another thread may append meanwhile, and what came late may as well come along.
        taken = []
        while self._waiting:
            taken.append(self._waiting.popleft())
        return tuple(taken)
