"""Link from the notebook to the bus with the faults of an adapter, its driver and its queue behind the guard."""

import random

import can

from hal.frame import Frame
from simbridge.faults.event_scheduler import EventScheduler
from simbridge.faults.frame_link import DelayedFrames, Deliver
from simbridge.faults.timed_fault import TimedFault

_OTHER_ID = 0x7E
"""Identifier without receiver."""


class FaultyTxLink:
    """Transmit link with a fault.

    off: sending fails. stuck: frames stay in the queue. slow: one frame leaves per period. delayed: late frames.
    garbage: random payloads. wrong: another identifier. intermittent: frames are lost.
    """

    def __init__(self, fault: TimedFault, time: EventScheduler, chance: random.Random) -> None:
        self._fault = fault
        self._time = time
        self._chance = chance
        self._queue = DelayedFrames(fault, time)
        self._next_at_s = fault.begin_s

    def carry(self, frame: can.Message, deliver: Deliver) -> None:
        """Carry a frame. Raises OSError if sending fails."""
        now_s = self._time.now_s()
        if not self._fault.acts(now_s):
            deliver(frame)
            return
        match self._fault.kind:
            case "off":
                raise OSError("Network is down")
            case "stuck":
                self._queue.add(frame, deliver, None)
            case "garbage":
                deliver(Frame(frame.arbitration_id, self._chance.randbytes(len(frame.data))))
            case "wrong":
                deliver(Frame(_OTHER_ID, bytes(frame.data)))
            case "slow":
                self._next_at_s = max(self._next_at_s, now_s) + self._fault.period_s
                self._queue.add(frame, deliver, self._next_at_s)
            case "delayed":
                self._queue.add(frame, deliver, now_s + self._fault.delay_s)
            case "intermittent":
                return
