"""A motor that does not do what it is told."""

import random
from collections import deque
from typing import NamedTuple

from hal.robot_settings import RobotSettings
from simbridge.faults.disturbance import TimedFault
from simbridge.faults.event_time import EventScheduler
from simbridge.wheels import Wheels

_FASTEST_M_S = 0.9
_WHIM_CYCLES = 40
"""A motor with a whim every cycle would hardly move."""


class Order(NamedTuple):
    """What one side is told in a cycle."""

    target_m_s: float
    brake: bool


class FaultyMotor:
    """One side's motor, disturbed: makes of what it is told what it does.

    off: it gets no current and rolls out. stuck: it goes on as it was last told, brake or not. garbage: it
    does anything. wrong: it turns the other way. slow: it follows with a time constant of the disturbance's period.
    delayed: it does everything late. intermittent: its cable has a loose contact.
    """

    def __init__(self, disturbance: TimedFault, time: EventScheduler, chance: random.Random, cycle_s: float) -> None:
        self._disturbance = disturbance
        self._time = time
        self._chance = chance
        self._last = Order(0.0, brake=False)
        self._late: deque[Order] = deque()
        self._late_cycles = max(1, round(disturbance.delay_s / cycle_s))
        self._slow_share = min(1.0, cycle_s / disturbance.period_s) if disturbance.period_s else 1.0
        self._slow_m_s = 0.0
        self._whim_m_s = 0.0
        self._whims = 0

    def does(self, order: Order) -> Order:
        """What becomes of the order of one cycle."""
        self._late.append(order)
        late = self._late.popleft() if len(self._late) > self._late_cycles else self._late[0]
        if not self._disturbance.acts(self._time.now_s()):
            self._last = order
            self._slow_m_s = order.target_m_s
            return order
        match self._disturbance.kind:
            case "off" | "intermittent":
                return Order(0.0, brake=False)
            case "stuck":
                return self._last
            case "garbage":
                if self._whims % _WHIM_CYCLES == 0:
                    self._whim_m_s = self._chance.uniform(-_FASTEST_M_S, _FASTEST_M_S)
                self._whims += 1
                return Order(self._whim_m_s, brake=False)
            case "wrong":
                return Order(-order.target_m_s, order.brake)
            case "slow":
                self._slow_m_s += (order.target_m_s - self._slow_m_s) * self._slow_share
                return Order(self._slow_m_s, brake=False)
            case "delayed":
                return late


class FaultyWheels(Wheels):
    """The wheels, with whatever is wrong with a side's motor now."""

    def __init__(self, robot: RobotSettings) -> None:
        super().__init__(robot)
        self._cycle_s = robot.can.cycle_s
        self._disturbed: dict[str, FaultyMotor] = {}
        """By part; a side is sound where there is none."""

    def disturb(self, part: str | None, disturbance: TimedFault, time: EventScheduler, chance: random.Random) -> None:
        """From now on `left_motor` or `right_motor` is disturbed; all is sound where it is another part, or none."""
        self._disturbed = {}
        if part in ("left_motor", "right_motor"):
            self._disturbed[part] = FaultyMotor(disturbance, time, chance, self._cycle_s)

    def turn(
        self, left_target_m_s: float, right_target_m_s: float, left_brake: bool = False, right_brake: bool = False
    ) -> None:
        """One cycle."""
        if "left_motor" in self._disturbed:
            left_target_m_s, left_brake = self._disturbed["left_motor"].does(Order(left_target_m_s, left_brake))
        if "right_motor" in self._disturbed:
            right_target_m_s, right_brake = self._disturbed["right_motor"].does(Order(right_target_m_s, right_brake))
        super().turn(left_target_m_s, right_target_m_s, left_brake, right_brake)
