"""Motors with faults."""

import random
from collections import deque
from typing import NamedTuple

from hal.kurt2_settings import Kurt2Settings
from simbridge.faults.event_scheduler import EventScheduler
from simbridge.faults.timed_fault import TimedFault
from simbridge.robot.wheels import Wheels

_FASTEST_M_S = 0.9
_TARGET_CYCLES = 40
"""Cycles per random target; with a new one in each cycle the motor would hardly move."""


class SideCommand(NamedTuple):
    """Command for one side in a cycle."""

    target_m_s: float
    brake: bool


class FaultyMotor:
    """Motor of one side with a fault.

    off: no current, the side rolls out. stuck: repeats the last command. garbage: random targets. wrong: turns the
    other way. slow: lag with the fault's period as time constant. delayed: late commands. intermittent: loose contact.
    """

    def __init__(self, fault: TimedFault, time: EventScheduler, chance: random.Random, cycle_s: float) -> None:
        self._fault = fault
        self._time = time
        self._chance = chance
        self._last = SideCommand(0.0, brake=False)
        self._late: deque[SideCommand] = deque()
        self._late_cycles = max(1, round(fault.delay_s / cycle_s))
        self._slow_ratio = min(1.0, cycle_s / fault.period_s) if fault.period_s else 1.0
        self._slow_m_s = 0.0
        self._random_m_s = 0.0
        self._garbage_cycles = 0

    def apply(self, command: SideCommand) -> SideCommand:
        """Return the command that the motor executes in place of `command`, under its fault."""
        self._late.append(command)
        late = self._late.popleft() if len(self._late) > self._late_cycles else self._late[0]
        if not self._fault.acts(self._time.now_s()):
            self._last = command
            self._slow_m_s = command.target_m_s
            return command
        match self._fault.kind:
            case "off" | "intermittent":
                return SideCommand(0.0, brake=False)
            case "stuck":
                return self._last
            case "garbage":
                if self._garbage_cycles % _TARGET_CYCLES == 0:
                    self._random_m_s = self._chance.uniform(-_FASTEST_M_S, _FASTEST_M_S)
                self._garbage_cycles += 1
                return SideCommand(self._random_m_s, brake=False)
            case "wrong":
                return SideCommand(-command.target_m_s, command.brake)
            case "slow":
                self._slow_m_s += (command.target_m_s - self._slow_m_s) * self._slow_ratio
                return SideCommand(self._slow_m_s, brake=False)
            case "delayed":
                return late


class FaultyWheels(Wheels):
    """Wheels with at most one faulty motor."""

    def __init__(self, robot: Kurt2Settings) -> None:
        super().__init__(robot)
        self._cycle_s = robot.cycle_s
        self._disturbed: dict[str, FaultyMotor] = {}
        """Faulty motor by part; other sides are sound."""

    def disturb(self, part: str | None, fault: TimedFault, time: EventScheduler, chance: random.Random) -> None:
        """Replace the fault: it hits `left_motor` or `right_motor`; any other part clears it."""
        self._disturbed = {}
        if part in ("left_motor", "right_motor"):
            self._disturbed[part] = FaultyMotor(fault, time, chance, self._cycle_s)

    def turn(
        self, left_target_m_s: float, right_target_m_s: float, left_brake: bool = False, right_brake: bool = False
    ) -> None:
        """Simulate one cycle towards the targets in m/s, as the motors execute them; a braked side slows down."""
        if "left_motor" in self._disturbed:
            left_target_m_s, left_brake = self._disturbed["left_motor"].apply(SideCommand(left_target_m_s, left_brake))
        if "right_motor" in self._disturbed:
            right_target_m_s, right_brake = self._disturbed["right_motor"].apply(
                SideCommand(right_target_m_s, right_brake)
            )
        super().turn(left_target_m_s, right_target_m_s, left_brake, right_brake)
