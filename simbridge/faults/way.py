"""The way of frames in one direction, straight or disturbed."""

import random
from collections import deque
from collections.abc import Callable, Set
from typing import Protocol

import can

from hal.frame import Frame
from simbridge.faults.disturbance import TimedFault
from simbridge.faults.event_time import EventScheduler

_ROUNDING_S = 1e-9

Deliver = Callable[[can.Message], None]


class FrameLink(Protocol):
    """Takes frames at one end and lets them arrive at the other, now, later or never."""

    def carry(self, frame: can.Message, arrive: Deliver) -> None:
        """A frame sets out. Raises OSError where it cannot."""
        ...


class IdealLink:
    """Each frame arrives at once."""

    def carry(self, frame: can.Message, arrive: Deliver) -> None:
        """It is there."""
        arrive(frame)


class FaultyLink:
    """Frames with some identifiers suffer, for the disturbance's span; they never overtake one another.

    What repeats itself repeats each identifier's last frame, unless `freeze` says what it is that stands still.
    """

    def __init__(
        self,
        disturbance: TimedFault,
        time: EventScheduler,
        chance: random.Random,
        concerns: Set[int] | None,
        *,
        freeze: Callable[[can.Message], can.Message] | None = None,
        falsify: Callable[[can.Message], list[can.Message]],
    ) -> None:
        """`concerns`: identifiers, None for all. `falsify`: what is plausible and false in place of a right frame."""
        self._disturbance = disturbance
        self._time = time
        self._chance = chance
        self._concerns = concerns
        self._freeze = freeze
        self._falsify = falsify
        self._newest: dict[int, can.Message] = {}
        self._passed_at_s: dict[int, float] = {}
        self._late: deque[tuple[can.Message, Deliver]] = deque()
        time.at(disturbance.end_s, self._let_all_arrive)

    def carry(self, frame: can.Message, arrive: Deliver) -> None:
        """A frame sets out."""
        if self._concerns is not None and frame.arbitration_id not in self._concerns:
            arrive(frame)
        elif not self._disturbance.acts(self._time.now_s()):
            self._newest[frame.arbitration_id] = frame
            arrive(frame)
        else:
            self._disturb(frame, arrive)

    def _disturb(self, frame: can.Message, arrive: Deliver) -> None:
        frame_id, now_s = frame.arbitration_id, self._time.now_s()
        match self._disturbance.kind:
            case "off" | "intermittent":
                return
            case "stuck":
                again = self._newest.get(frame_id, frame) if self._freeze is None else self._freeze(frame)
                arrive(Frame(frame_id, bytes(again.data)))  # anew: its old stamp would give it away
            case "garbage":
                arrive(Frame(frame_id, self._chance.randbytes(len(frame.data))))
            case "wrong":
                for each in self._falsify(frame):
                    arrive(each)
            case "slow":
                passed_at_s = self._passed_at_s.get(frame_id, self._disturbance.begin_s)
                if now_s - passed_at_s > self._disturbance.period_s - _ROUNDING_S:
                    self._passed_at_s[frame_id] = now_s
                    arrive(frame)
            case "delayed":
                self._late.append((frame, arrive))
                self._time.at(now_s + self._disturbance.delay_s, self._let_one_arrive)

    def _let_one_arrive(self) -> None:
        if self._late:
            frame, arrive = self._late.popleft()
            arrive(frame)

    def _let_all_arrive(self) -> None:
        while self._late:
            self._let_one_arrive()
