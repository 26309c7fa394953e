"""The way from the notebook to the bus: what an adapter, its driver and its queue can do to frames behind the guard."""

import random
from collections import deque

import can

from hal.frame import Frame
from simbridge.faults.disturbance import TimedFault
from simbridge.faults.event_time import EventScheduler
from simbridge.faults.way import Deliver

_ANOTHER_ID = 0x7E
"""Nobody listens to it."""


class FaultyTxLink:
    """off: sending fails. stuck: frames are taken and stay in the queue. slow: the queue moves once a period.

    garbage: payloads are garbled. wrong: the frames come out under another identifier. intermittent: taken and lost.
    """

    def __init__(self, disturbance: TimedFault, time: EventScheduler, chance: random.Random) -> None:
        self._disturbance = disturbance
        self._time = time
        self._chance = chance
        self._queue: deque[tuple[can.Message, Deliver]] = deque()
        self._next_at_s = disturbance.begin_s
        time.at(disturbance.end_s, self._let_all_out)

    def carry(self, frame: can.Message, arrive: Deliver) -> None:
        """A frame sets out. Raises OSError where sending fails."""
        now_s = self._time.now_s()
        if not self._disturbance.acts(now_s):
            arrive(frame)
            return
        match self._disturbance.kind:
            case "off":
                raise OSError("Network is down")
            case "stuck":
                self._queue.append((frame, arrive))
            case "garbage":
                arrive(Frame(frame.arbitration_id, self._chance.randbytes(len(frame.data))))
            case "wrong":
                arrive(Frame(_ANOTHER_ID, bytes(frame.data)))
            case "slow":
                self._next_at_s = max(self._next_at_s, now_s) + self._disturbance.period_s
                self._send_later(frame, arrive, self._next_at_s)
            case "delayed":
                self._send_later(frame, arrive, now_s + self._disturbance.delay_s)
            case "intermittent":
                return

    def _send_later(self, frame: can.Message, arrive: Deliver, at_s: float) -> None:
        self._queue.append((frame, arrive))
        self._time.at(at_s, self._let_one_out)

    def _let_one_out(self) -> None:
        if self._queue:
            frame, arrive = self._queue.popleft()
            arrive(frame)

    def _let_all_out(self) -> None:
        while self._queue:
            self._let_one_out()
