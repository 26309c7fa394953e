"""Motors of the two sides with their speed loops: set points in, rim speeds and encoder ticks out."""

import math
from typing import NamedTuple

from hal.numerics import round_portable
from hal.robot_settings import RobotSettings

REVERSAL_SPEED_M_S = 0.02
"""Slower than this a side may be driven the other way (firmware's SLOW_SPEED, 120 ticks in 100 ms)."""


class SideLaw(NamedTuple):
    """Numbers of the speed loop of one side's motor, for one cycle."""

    loop_gain: float
    """Fraction of the difference to the set point that a cycle takes away."""
    speed_up_m_s: float
    """Largest gain of speed in one cycle."""
    brake_m_s: float
    """Largest loss of speed in one cycle."""
    maximum_m_s: float


def next_speed(speed: float, target: float, brake: bool, law: SideLaw) -> float:
    """Return the rim speed of one side after a cycle towards a target, in m/s; a braked side ignores its target."""
    if brake:
        return 0.0 if abs(speed) <= law.brake_m_s else speed - math.copysign(law.brake_m_s, speed)
    if speed * target < 0 and abs(speed) > REVERSAL_SPEED_M_S:
        target = 0.0
    change = (target - speed) * law.loop_gain
    limit = law.speed_up_m_s if speed * change >= 0 else law.brake_m_s
    speed += change if -limit <= change <= limit else math.copysign(limit, change)
    return speed if abs(speed) <= law.maximum_m_s else math.copysign(law.maximum_m_s, speed)


class Wheels:
    """Three coupled wheels and one motor per side: a first-order lag with limits of acceleration and braking.

    Speeds are those of the rims: the wheels of a blocked robot slip, and its encoders count.
    """

    def __init__(self, robot: RobotSettings) -> None:
        motors, cycle_s = robot.motors, robot.cycle_s
        self.law = SideLaw(
            loop_gain=1.0 - round_portable(math.exp(-cycle_s / motors.speed_loop_time_s)),
            speed_up_m_s=motors.acceleration_m_s2 * cycle_s,
            brake_m_s=motors.braking_m_s2 * cycle_s,
            maximum_m_s=motors.maximum_speed_m_s,
        )
        self.ticks_per_speed = cycle_s / robot.geometry.metres_per_tick
        self.left_m_s = 0.0
        self.right_m_s = 0.0
        self._left_carry = 0.0
        self._right_carry = 0.0

    def turn(
        self, left_target_m_s: float, right_target_m_s: float, left_brake: bool = False, right_brake: bool = False
    ) -> None:
        """Simulate one cycle towards the targets in m/s; a braked side decelerates at its limit."""
        self.left_m_s = next_speed(self.left_m_s, left_target_m_s, left_brake, self.law)
        self.right_m_s = next_speed(self.right_m_s, right_target_m_s, right_brake, self.law)

    def take_ticks(self) -> tuple[int, int]:
        """Return the encoder ticks of this cycle, left and right; fractions are carried over."""
        left = self._left_carry + self.left_m_s * self.ticks_per_speed
        right = self._right_carry + self.right_m_s * self.ticks_per_speed
        left_ticks, right_ticks = math.floor(left), math.floor(right)
        self._left_carry, self._right_carry = left - left_ticks, right - right_ticks
        return left_ticks, right_ticks

    def run_at(self, left_m_s: float, right_m_s: float) -> None:
        """Turn at these rim speeds in m/s, after cycles that were left out."""
        self.left_m_s, self.right_m_s = left_m_s, right_m_s

    def halt(self) -> None:
        """Stop the wheels at once, for a repositioned robot."""
        self.left_m_s = self.right_m_s = self._left_carry = self._right_carry = 0.0

    @property
    def state(self) -> tuple[float, ...]:
        """All numbers that the next cycle depends on, for the state hash."""
        return self.left_m_s, self.right_m_s, self._left_carry, self._right_carry
