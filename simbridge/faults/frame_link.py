"""Links that carry frames in one direction, ideal or faulty."""

import random
from collections import deque
from collections.abc import Callable, Set
from typing import Protocol

import can

from hal.frame import Frame
from simbridge.faults.event_scheduler import EventScheduler
from simbridge.faults.timed_fault import TimedFault

_ROUNDING_S = 1e-9

Deliver = Callable[[can.Message], None]


class FrameLink(Protocol):
    """Link that delivers frames now, later or never."""

    def carry(self, frame: can.Message, deliver: Deliver) -> None:
        """Carry a frame: call `deliver` with it now, later or never. Raises OSError if sending fails."""
        ...


class IdealLink:
    """Link without delay or faults."""

    def carry(self, frame: can.Message, deliver: Deliver) -> None:
        """Deliver the frame at once."""
        deliver(frame)


class DelayedFrames:
    """First-in first-out queue of delayed frames; the end of the fault delivers the rest."""

    def __init__(self, fault: TimedFault, time: EventScheduler) -> None:
        self._time = time
        self._queue: deque[tuple[can.Message, Deliver]] = deque()
        time.at(fault.end_s, self._deliver_all)

    def add(self, frame: can.Message, deliver: Deliver, at_s: float | None) -> None:
        """Queue a frame; at `at_s`, in s, the oldest frame of the queue is delivered; None: no delivery is due."""
        self._queue.append((frame, deliver))
        if at_s is not None:
            self._time.at(at_s, self._deliver_oldest)

    def _deliver_oldest(self) -> None:
        if self._queue:
            frame, deliver = self._queue.popleft()
            deliver(frame)

    def _deliver_all(self) -> None:
        while self._queue:
            self._deliver_oldest()


class FaultyLink:
    """Link with a fault for some identifiers; frames never overtake each other.

    `stuck` repeats each identifier's last frame unless `freeze` is given.
    """

    def __init__(
        self,
        fault: TimedFault,
        time: EventScheduler,
        chance: random.Random,
        concerns: Set[int] | None,
        *,
        freeze: Callable[[can.Message], can.Message] | None = None,
        falsify: Callable[[can.Message], list[can.Message]],
    ) -> None:
        """Args: `concerns`: affected identifiers, None for all; `falsify`: false frames in place of a right one."""
        self._fault = fault
        self._time = time
        self._chance = chance
        self._concerns = concerns
        self._freeze = freeze
        self._falsify = falsify
        self._newest: dict[int, can.Message] = {}
        self._passed_at_s: dict[int, float] = {}
        self._late = DelayedFrames(fault, time)

    def carry(self, frame: can.Message, deliver: Deliver) -> None:
        """Carry a frame, changed, delayed or lost while the fault acts; otherwise deliver it at once."""
        if self._concerns is not None and frame.arbitration_id not in self._concerns:
            deliver(frame)
        elif not self._fault.acts(self._time.now_s()):
            self._newest[frame.arbitration_id] = frame
            deliver(frame)
        else:
            self._disturb(frame, deliver)

    def _disturb(self, frame: can.Message, deliver: Deliver) -> None:
        frame_id, now_s = frame.arbitration_id, self._time.now_s()
        match self._fault.kind:
            case "off" | "intermittent":
                return
            case "stuck":
                again = self._newest.get(frame_id, frame) if self._freeze is None else self._freeze(frame)
                # A new frame: the old timestamp would reveal the repetition.
                deliver(Frame(frame_id, bytes(again.data)))
            case "garbage":
                deliver(Frame(frame_id, self._chance.randbytes(len(frame.data))))
            case "wrong":
                for each in self._falsify(frame):
                    deliver(each)
            case "slow":
                passed_at_s = self._passed_at_s.get(frame_id, self._fault.begin_s)
                if now_s - passed_at_s > self._fault.period_s - _ROUNDING_S:
                    self._passed_at_s[frame_id] = now_s
                    deliver(frame)
            case "delayed":
                self._late.add(frame, deliver, now_s + self._fault.delay_s)
