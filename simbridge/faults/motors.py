"""A motor that does not do what it is told."""

import random
from collections import deque
from typing import Literal, NamedTuple

from hal.robot_settings import RobotSettings
from simbridge.faults.disturbance import Disturbance
from simbridge.faults.event_time import EventTime
from simbridge.wheels import Wheels

Side = Literal["left", "right"]
_FASTEST_M_S = 0.9
_WHIM_CYCLES = 40
"""A motor with a whim every cycle would hardly move."""


class _Order(NamedTuple):
    target_m_s: float
    brake: bool


class DisturbedWheels(Wheels):
    """The wheels, with one side's motor disturbed.

    off: it gets no current and rolls out. stuck: it goes on as it was last told, brake or not. garbage: it
    does anything. wrong: it turns the other way. slow: it follows with a time constant of the disturbance's period.
    delayed: it does everything late. intermittent: its cable has a loose contact.
    """

    def __init__(
        self, robot: RobotSettings, disturbance: Disturbance, side: Side, time: EventTime, chance: random.Random
    ) -> None:
        super().__init__(robot)
        self._disturbance = disturbance
        self._side = side
        self._time = time
        self._chance = chance
        self._last = _Order(0.0, brake=False)
        self._late: deque[_Order] = deque()
        self._late_cycles = max(1, round(disturbance.delay_s / robot.can.cycle_s))
        self._slow_share = min(1.0, robot.can.cycle_s / disturbance.period_s) if disturbance.period_s else 1.0
        self._slow_m_s = 0.0
        self._whim_m_s = 0.0
        self._whims = 0

    def turn(
        self, left_target_m_s: float, right_target_m_s: float, left_brake: bool = False, right_brake: bool = False
    ) -> None:
        """One cycle."""
        left, right = _Order(left_target_m_s, left_brake), _Order(right_target_m_s, right_brake)
        if self._side == "left":
            left = self._disturbed(left)
        else:
            right = self._disturbed(right)
        super().turn(left.target_m_s, right.target_m_s, left.brake, right.brake)

    def _disturbed(self, order: _Order) -> _Order:
        self._late.append(order)
        late = self._late.popleft() if len(self._late) > self._late_cycles else self._late[0]
        if not self._disturbance.acts(self._time.now_s()):
            self._last = order
            self._slow_m_s = order.target_m_s
            return order
        match self._disturbance.kind:
            case "off" | "intermittent":
                return _Order(0.0, brake=False)
            case "stuck":
                return self._last
            case "garbage":
                if self._whims % _WHIM_CYCLES == 0:
                    self._whim_m_s = self._chance.uniform(-_FASTEST_M_S, _FASTEST_M_S)
                self._whims += 1
                return _Order(self._whim_m_s, brake=False)
            case "wrong":
                return _Order(-order.target_m_s, order.brake)
            case "slow":
                self._slow_m_s += (order.target_m_s - self._slow_m_s) * self._slow_share
                return _Order(self._slow_m_s, brake=False)
            case "delayed":
                return late
