"""Detection of wheels that do not follow their set points, from the encoders and a band of possible speeds."""

import math

from hal.robot import STANDSTILL, WheelSpeeds
from hal.robot_settings import RobotSettings

SLOWEST = 2.0
"""An obedient side answers a set point at most this many times slower than the settings say. Acceleration, braking and
the time of the speed loop are our choice (docs/the-robot.md#motors-and-speed)."""
REVERSAL_SPEED_M_S = 0.02
"""Speed above which a side slows down before it reverses (firmware's SLOW_SPEED)."""


class WheelWatch:
    """Detector of a side whose speed leaves the band of possible speeds.

    An obedient side is between its set point and the slowest response to all set points so far. This band is wide while
    speeds change, and closes when they are constant. A side disobeys if it has been off the band by more than
    `wheel_error_m_s` and `wheel_error_share` for `wheel_error_s`. Time on the band counts against time off the band.
    """

    def __init__(self, robot: RobotSettings) -> None:
        limits = robot.guard
        self._metres_per_tick = robot.geometry.metres_per_tick
        # After a longer pause of runtime or encoders the set points are unknown: the watchdog or the controller has
        # stopped the robot, and the measured speeds are the start.
        self._pause_s = limits.ticks_ceased_s
        self._error_s = limits.wheel_error_s
        self._left, self._right = _Side(robot), _Side(robot)
        self._command = STANDSTILL
        self._counted_at_s = -math.inf

    def set_command(self, command: WheelSpeeds) -> None:
        """Note the set points in m/s that this tick's CONTROL carries, for the checks that follow."""
        self._command = command

    def check(self, left_ticks: int, right_ticks: int, turned_s: float, responded_s: float, now_s: float) -> str:
        """Return one line about a side that disobeys; empty while both obey. Call it in each tick. Times in s.

        The wheels turned by these ticks in `turned_s`; 0 if nothing was counted in this tick of the runtime. They had
        `responded_s` to respond to their set points, for which the bands widen or close.
        """
        left, right, command = self._left, self._right, self._command
        left.follow(command.left_m_s, responded_s)
        right.follow(command.right_m_s, responded_s)
        if turned_s <= 0.0:
            return ""
        left_m_s = left_ticks * self._metres_per_tick / turned_s
        right_m_s = right_ticks * self._metres_per_tick / turned_s
        silent_s = now_s - self._counted_at_s
        self._counted_at_s = now_s
        if not 0.0 <= silent_s <= self._pause_s:
            left.start(left_m_s)
            right.start(right_m_s)
            return ""
        left_off_s, right_off_s = left.off_s(left_m_s, silent_s), right.off_s(right_m_s, silent_s)
        if left_off_s >= self._error_s:
            return f"left wheels were told {command.left_m_s:.2f} m/s and turn at {left_m_s:.2f}"
        if right_off_s >= self._error_s:
            return f"right wheels were told {command.right_m_s:.2f} m/s and turn at {right_m_s:.2f}"
        return ""


class _Side:
    """Band of one side's speeds in m/s, and the time that the side has been off the band."""

    def __init__(self, robot: RobotSettings) -> None:
        motors, limits = robot.motors, robot.guard
        self._loop_s = SLOWEST * motors.speed_loop_time_s
        self._acceleration_m_s2 = motors.acceleration_m_s2 / SLOWEST
        self._braking_m_s2 = motors.braking_m_s2 / SLOWEST
        self._error_m_s = limits.wheel_error_m_s
        self._error_share = limits.wheel_error_share
        self._error_s = limits.wheel_error_s
        self._low_m_s = self._high_m_s = self._off_s = 0.0

    def start(self, speed_m_s: float) -> None:
        """Start the band from one measured speed."""
        self._low_m_s = self._high_m_s = speed_m_s

    def follow(self, told_m_s: float, elapsed_s: float) -> None:
        """Widen or close the band for `elapsed_s` with this set point."""
        low_m_s, high_m_s = self._low_m_s, self._high_m_s
        self._low_m_s = told_m_s if told_m_s <= low_m_s else self._slowest(low_m_s, told_m_s, elapsed_s)
        self._high_m_s = told_m_s if told_m_s >= high_m_s else self._slowest(high_m_s, told_m_s, elapsed_s)

    def off_s(self, speed_m_s: float, elapsed_s: float) -> float:
        """Return the time off the band, after `elapsed_s` at this speed; at most `wheel_error_s`."""
        low_m_s, high_m_s = self._low_m_s, self._high_m_s
        below_m_s = low_m_s - speed_m_s - self._error_share * abs(low_m_s)
        above_m_s = speed_m_s - high_m_s - self._error_share * abs(high_m_s)
        if below_m_s > self._error_m_s or above_m_s > self._error_m_s:
            self._off_s = min(self._error_s, self._off_s + elapsed_s)
        else:
            self._off_s = max(0.0, self._off_s - elapsed_s)
        return self._off_s

    def _slowest(self, speed_m_s: float, told_m_s: float, elapsed_s: float) -> float:
        """Return the speed of the slowest obedient side after `elapsed_s`."""
        if speed_m_s * told_m_s < 0.0 and abs(speed_m_s) > REVERSAL_SPEED_M_S:
            told_m_s = 0.0
        change_m_s = (told_m_s - speed_m_s) * elapsed_s / (self._loop_s + elapsed_s)
        speeds_up = speed_m_s * change_m_s >= 0.0
        most_m_s = (self._acceleration_m_s2 if speeds_up else self._braking_m_s2) * elapsed_s
        slowest_m_s = speed_m_s + max(-most_m_s, min(most_m_s, change_m_s))
        # Braking is quicker than speeding up: a step that began with the one must not end as the other.
        return slowest_m_s if slowest_m_s * speed_m_s >= 0.0 else 0.0
