"""Cable without transmission time; timestamps and confirmations are SocketCAN's."""

import copy
from collections import deque
from collections.abc import Callable

import can

from hal.bus_frame import is_heard
from hal.frame import Frame

_MOST_WAITING = 4096


class Cable:
    """Cable between its ends."""

    def __init__(self, now_s: Callable[[], float]) -> None:
        """`now_s`: returns the time in s."""
        self.now_s = now_s
        self._ends: list[CableInterface] = []

    def join(self, end: "CableInterface") -> "CableInterface":
        """Let an end of this cable receive the frames that are carried from now on."""
        self._ends.append(end)
        return end

    def carry(self, frame: can.Message, sender: "CableInterface") -> None:
        """Deliver a copy of a frame to every end; the sender gets it once, as its confirmation."""
        for end in self._ends:
            if is_heard(frame, end.accepted_ids):
                self.deliver(frame, end, own=end is sender)

    def deliver(self, frame: can.Message, end: "CableInterface", *, own: bool) -> None:
        """Deliver a frame to an end that hears it; a poor cable may do otherwise. `own`: whether this end sent it."""
        end.deliver(frame, self.now_s(), own=own)

    def leave(self, end: "CableInterface") -> None:
        """Remove an end; repeated calls do nothing."""
        if end in self._ends:
            self._ends.remove(end)


class CableInterface:
    """End of a cable (hal.bus.CanInterface)."""

    receives_own_frames = True

    def __init__(self, cable: Cable) -> None:
        self._cable = cable
        self._waiting: deque[can.Message] = deque()
        """Frames in the order of their arrival, also those that are still on the way."""
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
        if self._waiting and self._waiting[0].timestamp <= self._cable.now_s():
            return self._waiting.popleft()
        return None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002
        """Send a frame without waiting `timeout` s. Raises can.CanOperationError after shutdown."""
        self._check_open()
        self._cable.carry(msg, self)

    def send_if_open(self, frame: can.Message) -> None:
        """Send a frame that was held up, unless this end is shut down: what waits in a driver is gone with it."""
        if self._open:
            self._cable.carry(frame, self)

    def shutdown(self) -> None:
        """Unplug the end; repeated calls do nothing."""
        self._open = False
        self._cable.leave(self)

    def deliver(self, frame: can.Message, at_s: float, *, own: bool) -> None:
        """Queue a copy of a frame that arrives at `at_s`, in s, and is so stamped; `own`: whether this end sent it."""
        if len(self._waiting) >= _MOST_WAITING:
            self.overruns += 1
            return
        # Half the time of copy.copy, which first looks the method up.
        mine = frame.__copy__() if isinstance(frame, Frame) else copy.copy(frame)
        mine.timestamp = at_s
        mine.is_rx = not own
        self._waiting.append(mine)

    def _check_open(self) -> None:
        if not self._open:
            raise can.CanOperationError("this end of the cable is shut down")
