"""Cable without transmission time; timestamps and confirmations are SocketCAN's."""

import copy
from collections import deque
from collections.abc import Callable

import can

from hal.bus_frame import is_heard
from hal.frame import Frame

_MOST_WAITING = 4096


class Cable:
    """Cable between its ends, on the clock `now_s` in s."""

    def __init__(self, now_s: Callable[[], float]) -> None:
        self.now_s = now_s
        self._ends: list[CableInterface] = []

    def open(self) -> "CableInterface":
        """Return a new end; it receives the frames that are carried from now on."""
        end = CableInterface(self)
        self._ends.append(end)
        return end

    def carry(self, frame: can.Message, sender: "CableInterface") -> None:
        """Deliver a copy of a frame to every end, the sender's included."""
        now_s = self.now_s()
        for end in self._ends:
            if is_heard(frame, end.accepted_ids):
                end.deliver(frame, now_s, own=end is sender)

    def leave(self, end: "CableInterface") -> None:
        """Remove an end; repeated calls do nothing."""
        if end in self._ends:
            self._ends.remove(end)


class CableInterface:
    """End of a cable (hal.can_interface.CanInterface)."""

    receives_own_frames = True

    def __init__(self, cable: Cable) -> None:
        self._cable = cable
        self._waiting: deque[can.Message] = deque()
        self.accepted_ids: frozenset[int] | None = None
        """Accepted identifiers; None accepts all."""
        self._open = True
        self.overruns = 0
        """Number of frames dropped because the queue was full."""

    def now_s(self) -> float | None:
        """Return the cable's time in s."""
        return self._cable.now_s()

    def set_id_filter(self, frame_ids: frozenset[int]) -> None:
        """Accept only these standard identifiers and error frames; applies to queued frames too."""
        self.accepted_ids = frame_ids
        self._waiting = deque(frame for frame in self._waiting if is_heard(frame, frame_ids))

    def recv(self, timeout: float | None = None) -> can.Message | None:  # noqa: ARG002 - it never waits
        """Return the oldest frame or None without waiting `timeout` s. Raises can.CanOperationError after shutdown."""
        self._check_open()
        return self._waiting.popleft() if self._waiting else None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002
        """Send a frame without waiting `timeout` s. Raises can.CanOperationError after shutdown."""
        self._check_open()
        self._cable.carry(msg, self)

    def shutdown(self) -> None:
        """Unplug the end; repeated calls do nothing."""
        self._open = False
        self._cable.leave(self)

    def deliver(self, frame: can.Message, now_s: float, *, own: bool) -> None:
        """Queue a copy of a frame, stamped with `now_s`, in s; `own`: whether this end sent it."""
        if len(self._waiting) >= _MOST_WAITING:
            self.overruns += 1
            return
        # Half the time of copy.copy, which first looks the method up.
        mine = frame.__copy__() if isinstance(frame, Frame) else copy.copy(frame)
        mine.timestamp = now_s
        mine.is_rx = not own
        self._waiting.append(mine)

    def _check_open(self) -> None:
        if not self._open:
            raise can.CanOperationError("this end of the cable is shut down")
