"""Link from the notebook to the bus with the faults of an adapter, its driver and its queue behind the guard."""

import random
from collections import deque

import can

from hal.frame import Frame
from simbridge.faults.disturbance import TimedFault
from simbridge.faults.event_time import EventScheduler
from simbridge.faults.way import Deliver

_OTHER_ID = 0x7E
"""Identifier without receiver."""


class FaultyTxLink:
    """Transmit link with a fault.

    off: sending fails. stuck: frames stay in the queue. slow: one frame leaves per period. delayed: late frames.
    garbage: random payloads. wrong: another identifier. intermittent: frames are lost.
    """

    def __init__(self, disturbance: TimedFault, time: EventScheduler, chance: random.Random) -> None:
        self._disturbance = disturbance
        self._time = time
        self._chance = chance
        self._queue: deque[tuple[can.Message, Deliver]] = deque()
        self._next_at_s = disturbance.begin_s
        time.at(disturbance.end_s, self._send_all)

    def carry(self, frame: can.Message, deliver: Deliver) -> None:
        """Carry a frame. Raises OSError if sending fails."""
        now_s = self._time.now_s()
        if not self._disturbance.acts(now_s):
            deliver(frame)
            return
        match self._disturbance.kind:
            case "off":
                raise OSError("Network is down")
            case "stuck":
                self._queue.append((frame, deliver))
            case "garbage":
                deliver(Frame(frame.arbitration_id, self._chance.randbytes(len(frame.data))))
            case "wrong":
                deliver(Frame(_OTHER_ID, bytes(frame.data)))
            case "slow":
                self._next_at_s = max(self._next_at_s, now_s) + self._disturbance.period_s
                self._send_later(frame, deliver, self._next_at_s)
            case "delayed":
                self._send_later(frame, deliver, now_s + self._disturbance.delay_s)
            case "intermittent":
                return

    def _send_later(self, frame: can.Message, deliver: Deliver, at_s: float) -> None:
        self._queue.append((frame, deliver))
        self._time.at(at_s, self._send_one)

    def _send_one(self) -> None:
        if self._queue:
            frame, deliver = self._queue.popleft()
            deliver(frame)

    def _send_all(self) -> None:
        while self._queue:
            self._send_one()
