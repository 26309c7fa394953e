"""Motors with faults."""

import random
from collections import deque
from typing import NamedTuple

from hal.robot_settings import RobotSettings
from simbridge.robot.wheels import Wheels
from tests.stories.fault import FaultInjection
from tests.stories.table import Target

_FASTEST_M_S = 0.9
_TARGET_CYCLES = 40
"""Cycles per random target; with a new one in each cycle the motor would hardly move."""
_MOST_LATE_CYCLES = 200


class _Command(NamedTuple):
    """Command for one side in a cycle."""

    target_m_s: float
    brake: bool


class _Motor:
    """Motor of one side.

    off: no current, the side rolls out. stuck: repeats the last command. garbage: random targets. wrong: turns the
    other way. slow: lag with the fault's period as time constant. delayed: late commands. intermittent: loose contact.
    """

    def __init__(self, side: Target, injection: FaultInjection, chance: random.Random, cycle_s: float) -> None:
        self._side, self._injection = side, injection
        self._chance, self._cycle_s = chance, cycle_s
        self._commands: deque[_Command] = deque([_Command(0.0, False)], maxlen=_MOST_LATE_CYCLES)
        self._last = self._commands[0]
        self._slow_m_s = self._random_m_s = 0.0
        self._garbage_cycles = 0

    def apply(self, target_m_s: float, brake: bool) -> _Command:
        """Return the command that the motor executes in place of this one."""
        command = _Command(target_m_s, brake)
        self._commands.append(command)
        fault = self._injection.acting_on(self._side)
        if fault is None:
            self._last = command
            self._slow_m_s = command.target_m_s
            self._garbage_cycles = 0
            return command
        match fault.kind:
            case "off" | "intermittent":
                return _Command(0.0, brake=False)
            case "stuck":
                return self._last
            case "garbage":
                if self._garbage_cycles % _TARGET_CYCLES == 0:
                    self._random_m_s = self._chance.uniform(-_FASTEST_M_S, _FASTEST_M_S)
                self._garbage_cycles += 1
                return _Command(self._random_m_s, brake=False)
            case "wrong":
                return _Command(-command.target_m_s, command.brake)
            case "slow":
                self._slow_m_s += (command.target_m_s - self._slow_m_s) * self._cycle_s / fault.period_s
                return _Command(self._slow_m_s, brake=False)
            case "delayed":
                return self._commands[-min(len(self._commands), 1 + round(fault.delay_s / self._cycle_s))]
            case _:
                raise AssertionError(f"no fault of a motor: {fault}")


class FaultyWheels(Wheels):
    """Wheels whose motors may fail."""

    def __init__(self, robot: RobotSettings, injection: FaultInjection, chance: random.Random) -> None:
        super().__init__(robot)
        self._left = _Motor("left_motor", injection, chance, robot.cycle_s)
        self._right = _Motor("right_motor", injection, chance, robot.cycle_s)

    def turn(
        self, left_target_m_s: float, right_target_m_s: float, left_brake: bool = False, right_brake: bool = False
    ) -> None:
        left = self._left.apply(left_target_m_s, left_brake)
        right = self._right.apply(right_target_m_s, right_brake)
        super().turn(left.target_m_s, right.target_m_s, left.brake, right.brake)
