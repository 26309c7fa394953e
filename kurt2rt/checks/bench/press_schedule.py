"""Schedule of presses, and the times from press to wheels."""

import random
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from hal.robot import STANDSTILL, GuardResult, Robot, WheelSpeeds
from hal.robot_proxy import RobotProxy
from kurt2rt.platform.clock import Clock

SPEED_M_S = 0.05
"""Slow speed, alternately forward and backward, so that the robot stays and each frame identifies its press."""
_HELD_S = (0.10, 0.15)
_UNTIL_NEXT_S = (0.25, 0.40)


class PressSchedule(NamedTuple):
    """Duration of a press and its interval in s, no multiple of any period of the robot."""

    held_s: float
    next_s: float


class PressTime(NamedTuple):
    """Time and direction of a press."""

    at_ns: int
    """Machine's monotonic clock, which all processes share."""
    forward: bool


class PressStart(NamedTuple):
    """First CONTROL frame with a speed after one without."""

    at_ns: int
    forward: bool


def press_schedules(seed: int) -> Iterator[PressSchedule]:
    """Yield random schedules of presses without end; equal seeds give equal schedules."""
    chance = random.Random(seed)
    while True:
        yield PressSchedule(chance.uniform(*_HELD_S), chance.uniform(*_UNTIL_NEXT_S))


def waits_ns(presses: Sequence[PressTime], starts: Sequence[PressStart]) -> list[int]:
    """Return the times in ns from presses to the start of the wheels, if that came before the next press.

    `presses` and `starts`: in order of time, with times in ns.
    """
    waits = []
    for number, press in enumerate(presses):
        until_ns = presses[number + 1].at_ns if number + 1 < len(presses) else None
        for start in starts:
            after = press.at_ns <= start.at_ns and (until_ns is None or start.at_ns < until_ns)
            if after and start.forward is press.forward:
                waits.append(start.at_ns - press.at_ns)
                break
    return waits


class ObservedRobot(RobotProxy):
    """Robot proxy that records each start of the wheels."""

    def __init__(self, robot: Robot, clock: Clock) -> None:
        """`clock`: the machine's monotonic clock."""
        super().__init__(robot)
        self.starts: list[PressStart] = []
        self._clock = clock
        self._stood = True

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        """Forward to the robot, speeds in m/s and times in s; afterwards the frame is on the bus."""
        grant = self._robot.drive(wanted, decided_at_s, now_s)
        stands = grant.wheel_speeds == STANDSTILL
        if self._stood and not stands:
            self.starts.append(PressStart(round(self._clock.now_s() * 1e9), grant.wheel_speeds.left_m_s > 0.0))
        self._stood = stands
        return grant
