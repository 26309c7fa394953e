"""A bus whose clock and traffic lie in the test's hand, and a robot that drives on it."""

import copy
import itertools

import can

from hal.bus import CanBus, open_bus
from hal.control import Control
from hal.in_process_bus import InProcessBus
from hal.kurt2 import Kurt2
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from tests.hal.helpers import ROBOT, TICK_S, controls, cycle, ticks

_numbers = itertools.count()


class DeskBus(InProcessBus):
    """One end that stamps frames and confirms its own, as the kernel's does; the others on its bus are as ever."""

    receives_own_frames = True

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.time_s = 1000.0
        """What its clock shows."""
        self.carries = True
        """False: sent frames wait, as on a bus without acknowledgement."""
        self._waiting: list[can.Message] = []

    def now_s(self) -> float | None:
        return self.time_s

    def arrive(self, *frames: can.Message, ago_s: float = 0.0) -> None:
        """Frames of others come, stamped with a time that long ago."""
        for frame in frames:
            self._put(frame, is_rx=True, stamp_s=self.time_s - ago_s)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:  # noqa: ARG002 - it never waits
        self._waiting.append(msg)
        if self.carries:
            self.carry()

    def carry(self) -> None:
        """Carry the waiting frames and confirm them."""
        waiting, self._waiting = self._waiting, []
        for frame in waiting:
            super().send(frame)
            self._put(frame, is_rx=False, stamp_s=self.time_s)

    def lose(self) -> None:
        """Drop the waiting frames silently."""
        self._waiting.clear()

    def _put(self, frame: can.Message, *, is_rx: bool, stamp_s: float) -> None:
        frame = copy.copy(frame)
        frame.is_rx, frame.timestamp = is_rx, stamp_s
        self.queue.put(frame)


class Ride:
    """A robot on the desk whose wheels do as they are told and whose sensors live, until a test says otherwise."""

    def __init__(self) -> None:
        self._name = f"desk-{next(_numbers)}"
        self.desk = DeskBus(self._name)
        self.openings = 0
        self.kurt2 = Kurt2(ROBOT, CanBus("can0", self._open))
        self._far_end = open_bus(f"virtual:{self._name}")
        self.now_s = 50.0
        self.applied = STANDSTILL
        self._counts = itertools.cycle((200, 201))

    def _open(self, _: str) -> DeskBus:
        self.openings += 1
        if self.openings > 1:
            before, self.desk = self.desk, DeskBus(self._name)
            self.desk.time_s, self.desk.carries = before.time_s, before.carries
        return self.desk

    def frames(self) -> list[can.Message]:
        """Return the frames that the controller sends in a cycle."""
        left_m_s, right_m_s = self.applied
        return [*cycle(next(self._counts), ticks(left_m_s), ticks(right_m_s))]

    def sleep(self, seconds: float) -> None:
        """Time passes and the runtime does nothing."""
        self.now_s += seconds
        self.desk.time_s += seconds

    def tick(self, left_m_s: float = 0.3, right_m_s: float = 0.3) -> GuardResult:
        """Run a cycle of the controller, and a tick of the runtime that requests these speeds."""
        self.desk.arrive(*self.frames())
        self.sleep(TICK_S)
        return self.decide(left_m_s, right_m_s)

    def decide(self, left_m_s: float = 0.3, right_m_s: float = 0.3) -> GuardResult:
        """Run a tick of the runtime with the waiting frames."""
        self.kurt2.sense(self.now_s)
        grant = self.kurt2.drive(WheelSpeeds(left_m_s, right_m_s), self.now_s, self.now_s)
        self.applied = grant.wheel_speeds
        return grant

    def drive_for(self, seconds: float, left_m_s: float = 0.3, right_m_s: float = 0.3) -> GuardResult:
        for _ in range(round(seconds / TICK_S)):
            grant = self.tick(left_m_s, right_m_s)
        return grant

    def sent(self) -> list[Control]:
        """Return the CONTROL values since the last call."""
        return controls(self._far_end)

    def close(self) -> None:
        self.kurt2.close()
        self._far_end.shutdown()
