"""A cable on which frames take no time: two ends, with stamps and confirmations as SocketCAN has them."""

import copy
from collections import deque
from collections.abc import Callable

import can

from hal.bus_frame import is_heard
from hal.frame import Frame

_MOST_WAITING = 4096


class Cable:
    """Joins its ends; time is that of the clock it is given."""

    def __init__(self, now_s: Callable[[], float]) -> None:
        self.now_s = now_s
        self._ends: list[CableInterface] = []

    def open(self) -> "CableInterface":
        """One more end."""
        end = CableInterface(self)
        self._ends.append(end)
        return end

    def carry(self, frame: can.Message, sender: "CableInterface") -> None:
        """A copy for everybody, the sender too."""
        now_s = self.now_s()
        for end in self._ends:
            if is_heard(frame, end.heard):
                end.hear(frame, now_s, own=end is sender)

    def leave(self, end: "CableInterface") -> None:
        """One end less; it may have left already."""
        if end in self._ends:
            self._ends.remove(end)


class CableInterface:
    """One end (hal.can_interface.CanInterface)."""

    receives_own_frames = True

    def __init__(self, cable: Cable) -> None:
        self._cable = cable
        self._waiting: deque[can.Message] = deque()
        self.heard: frozenset[int] | None = None
        """Identifiers that it wants; None: all."""
        self._open = True
        self.overruns = 0
        """Frames that found no room, for nobody took them."""

    def now_s(self) -> float | None:
        """As the cable has it."""
        return self._cable.now_s()

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Deliver only frames with these standard identifiers, and error frames, also of those that wait."""
        self.heard = frame_ids
        self._waiting = deque(frame for frame in self._waiting if is_heard(frame, frame_ids))

    def recv(self, timeout: float | None = None) -> can.Message | None:  # noqa: ARG002 - it never waits
        """The frame that waits longest. Raises can.CanOperationError after shutdown."""
        self._check_open()
        return self._waiting.popleft() if self._waiting else None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002
        """It is there. Raises can.CanOperationError after shutdown."""
        self._check_open()
        self._cable.carry(msg, self)

    def shutdown(self) -> None:
        """Unplug it; may be called twice."""
        self._open = False
        self._cable.leave(self)

    def hear(self, frame: can.Message, now_s: float, *, own: bool) -> None:
        """Take a copy."""
        if len(self._waiting) >= _MOST_WAITING:
            self.overruns += 1
            return
        # Twice as quick as copy.copy, which asks first how.
        mine = frame.__copy__() if isinstance(frame, Frame) else copy.copy(frame)
        mine.timestamp = now_s
        mine.is_rx = not own
        self._waiting.append(mine)

    def _check_open(self) -> None:
        if not self._open:
            raise can.CanOperationError("this end of the cable is shut down")
