"""Instruments besides distance sensors: odometry, gyroscope, tilt, motor currents, temperature.

Coarse models that follow the motion, so that recordings look real; the runtime does not use them. Numbers are our
choice unless docs/the-robot.md gives them.
"""

import math

from hal.numerics import cos_sin, round_portable
from hal.odometry import PlanePose
from hal.robot_settings import RobotSettings
from simbridge.robot.body import Body
from simbridge.robot.wheels import Wheels

_GRAVITY_M_S2 = 9.81
_TILT_ZERO, _TILT_PER_G = 32768, 3932
_GYRO_PER_DEG = 4992511
_GYRO_VARIANCE_PER_DEG2 = 10000
_GYRO_DRIFT_DEG_S = 0.01
_GYRO_VARIANCE_DEG2_S = 0.02
_COMPASS_PER_TURN = 65536
_IDLE_MA, _ROLLING_MA_S_M, _ACCELERATING_MA_S2_M = 150.0, 900.0, 1200.0
_COLD_BOARD, _BOARD_RISE, _BOARD_TIME_S = 24.0, 12.0, 600.0
_U32 = 1 << 32


class Instruments:
    """Simulated instruments other than distance sensors, whose raw values the slow telemetry frames carry."""

    def __init__(self, robot: RobotSettings, body: Body, wheels: Wheels) -> None:
        self._body = body
        self._wheels = wheels
        self._cycle_s = robot.cycle_s
        self._metres_per_tick = robot.geometry.metres_per_tick
        self._track_m = robot.geometry.effective_track_m
        self.reset()

    def reset(self) -> None:
        """Reset all counters, as MC_RESET does."""
        self.cycles = 0
        self._left_ticks = self._right_ticks = 0
        self._pose = PlanePose()
        self._drift_deg_s = _GYRO_DRIFT_DEG_S
        self._wheels_before = (0, self._wheels.left_m_s, self._wheels.right_m_s)
        self._speed_before = (0, self._forward_m_s())
        self.zero_gyro()

    def count(self, left_ticks: int, right_ticks: int) -> None:
        """Add one cycle's encoder ticks to the odometry."""
        self.cycles += 1
        self._left_ticks += left_ticks
        self._right_ticks += right_ticks
        turned_rad = (right_ticks - left_ticks) * self._metres_per_tick / self._track_m
        forward_m = (left_ticks + right_ticks) * self._metres_per_tick / 2
        self._pose = self._pose.moved(forward_m, turned_rad)

    def set_angle(self, angle_rad: float) -> None:
        """Set the odometry's heading (UPDATE_ANGLE)."""
        self._pose = self._pose._replace(heading_rad=angle_rad)

    def zero_gyro(self) -> None:
        """Set the gyroscope's angle to 0 (RESET_GYRO)."""
        self._gyro_zero_rad = self._body.pose.heading_rad
        self._gyro_zero_cycle = self.cycles

    def calibrate_gyro(self) -> None:
        """Stop the gyroscope's drift (CALIBRATE_GYRO)."""
        self._drift_deg_s = 0.0

    def deadreck(self) -> tuple[int, ...]:
        """Return DEADRECK: x and y in mm, heading in 0.01 deg."""
        return (
            _signed(round(self._pose.x_m * 1000), 24),
            _signed(round(self._pose.y_m * 1000), 24),
            round(_wrapped_deg(math.degrees(self._pose.heading_rad)) * 100),
        )

    def getspeed(self) -> tuple[int, ...]:
        """Return GETSPEED: accumulated ticks, left and right."""
        return _signed(self._left_ticks, 32), _signed(self._right_ticks, 32)

    def gyro(self) -> tuple[int, ...]:
        """Return GYRO_MC1 and GYRO_MC2: raw angle and variance."""
        since_s = (self.cycles - self._gyro_zero_cycle) * self._cycle_s
        turned_deg = math.degrees(self._body.pose.heading_rad - self._gyro_zero_rad) + self._drift_deg_s * since_s
        variance = round(_GYRO_VARIANCE_DEG2_S * since_s * _GYRO_VARIANCE_PER_DEG2)
        return round(_wrapped_deg(turned_deg) * _GYRO_PER_DEG), min(_U32 - 1, variance)

    def tilt(self) -> tuple[int, ...]:
        """Return TILT_COMP: raw accelerations to the left and to the front, 0, raw compass."""
        forward_m_s = self._forward_m_s()
        before_cycle, before_m_s = self._speed_before
        self._speed_before = (self.cycles, forward_m_s)
        elapsed_s = max(1, self.cycles - before_cycle) * self._cycle_s
        front_g = (forward_m_s - before_m_s) / elapsed_s / _GRAVITY_M_S2
        left_g = forward_m_s * self._body.velocity[2] / _GRAVITY_M_S2
        turns = self._body.pose.heading_rad / math.tau
        return _tilt(left_g), _tilt(front_g), 0, int(turns * _COMPASS_PER_TURN) % _COMPASS_PER_TURN

    def currents(self) -> tuple[int, ...]:
        """Return ADC12_15: current of the right and the left motor in mA, 0, board temperature."""
        before_cycle, left_before, right_before = self._wheels_before
        left, right = self._wheels.left_m_s, self._wheels.right_m_s
        self._wheels_before = (self.cycles, left, right)
        elapsed_s = max(1, self.cycles - before_cycle) * self._cycle_s
        warm = 1.0 - round_portable(math.exp(-self.cycles * self._cycle_s / _BOARD_TIME_S))
        return (
            _current_ma(right, (right - right_before) / elapsed_s),
            _current_ma(left, (left - left_before) / elapsed_s),
            0,
            round(_COLD_BOARD + _BOARD_RISE * warm),
        )

    def _forward_m_s(self) -> float:
        x_m_s, y_m_s, _ = self._body.velocity
        cos, sin = cos_sin(self._body.pose.heading_rad)
        return x_m_s * cos + y_m_s * sin


def _current_ma(speed_m_s: float, acceleration_m_s2: float) -> int:
    if speed_m_s == 0.0:
        return round(_IDLE_MA)
    pull_ma = _ROLLING_MA_S_M * abs(speed_m_s) + _ACCELERATING_MA_S2_M * math.copysign(1, speed_m_s) * acceleration_m_s2
    return round(_IDLE_MA + max(0.0, pull_ma))


def _tilt(acceleration_g: float) -> int:
    return min(65535, max(0, round(_TILT_ZERO + _TILT_PER_G * acceleration_g)))


def _wrapped_deg(angle_deg: float) -> float:
    return math.remainder(angle_deg, 360.0)


def _signed(value: int, bits: int) -> int:
    """Return the value wrapped to a signed counter of `bits` bits."""
    half = 1 << (bits - 1)
    return (value + half) % (1 << bits) - half
