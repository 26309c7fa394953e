"""Frames of CONTROL read byte by byte, in bulk, laid out as in docs/the-robot.md#control-modes; without hal.control."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hal.kurt2_settings import Kurt2MotorSettings, Kurt2Settings, SpeedMode

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

BRAKE = np.array([0, 0, 1, 0x03, 0xFF, 1, 0x03, 0xFF], dtype=np.uint8)
"""The emergency stop: RAW, no drive, brake on both sides."""
_SLACK_M_S = 1e-6
"""Rounding of fractions that are meant to be whole (0.29 m/s is 28.999999999999996 cm/s)."""


class Side(NamedTuple):
    """Set points of one side in m/s, one number for each frame."""

    speed_m_s: Floats
    low_m_s: Floats
    """The set point that was truncated to this frame is not below this."""
    high_m_s: Floats
    """Nor above this."""
    stands: Flags
    """The side is told to stand, where a motor that nothing regulates is braked."""

    def of(self, frames: NDArray[np.int64]) -> "Side":
        """Return the set points of some frames, by number."""
        return Side(self.speed_m_s[frames], self.low_m_s[frames], self.high_m_s[frames], self.stands[frames])

    def where(self, told: Flags) -> "Side":
        """Return the set points where the mask is true, standstill elsewhere."""
        speed_m_s, low_m_s, high_m_s = (np.where(told, speeds, 0.0) for speeds in self[:3])
        return Side(speed_m_s, low_m_s, high_m_s, self.stands | ~told)


class ControlFrames(NamedTuple):
    """Frames, read as the robot's mode has them."""

    brakes: Flags
    """It is the emergency stop. In RAW mode so is a set point of standing."""
    set_points: Flags
    """It is a set point in the robot's mode, with nothing else in it."""
    left: Side
    right: Side


def read_control(robot: Kurt2Settings, payloads: NDArray[np.uint8]) -> ControlFrames:
    """Frames of eight bytes each, (frames, 8)."""
    brakes = (payloads == BRAKE).all(axis=1)
    mode = payloads[:, 0].astype(np.int64) * 256 + payloads[:, 1]
    if robot.can.speed_mode is SpeedMode.RAW:
        left, left_plain = _raw_side(robot.motors, payloads[:, 2:5])
        right, right_plain = _raw_side(robot.motors, payloads[:, 5:8])
        return ControlFrames(brakes, (mode == 0) & left_plain & right_plain, left, right)
    in_percent = robot.can.speed_mode is SpeedMode.SPEED
    unit_m_s = robot.motors.full_speed_m_s / 100.0 if in_percent else 0.01
    units = payloads[:, 2:6].copy().view(">i2").astype(np.int64)
    rest = payloads[:, 6].astype(np.int64) * 256 + payloads[:, 7]
    # Yaw rate 0, and in SPEED_CM `keep`.
    plain = (mode == 1) & (rest == 0) if in_percent else (mode == 2) & (rest == 1)
    if in_percent:
        plain &= (np.abs(units) <= 100).all(axis=1)
    most = 100 if in_percent else np.inf
    left, right = (_unit_side(units[:, side], unit_m_s, most) for side in (0, 1))
    return ControlFrames(brakes, plain, left, right)


def _unit_side(units: NDArray[np.int64], unit_m_s: float, most: float) -> Side:
    magnitude: Floats = np.where(np.abs(units) >= most, np.inf, (np.abs(units) + 1) * unit_m_s)
    return _side((units * unit_m_s).astype(np.float64), magnitude, units < 0, units == 0, units == 0)


def _raw_side(motors: Kurt2MotorSettings, payloads: NDArray[np.uint8]) -> tuple[Side, Flags]:
    flags = payloads[:, 0]
    pwm = payloads[:, 1].astype(np.int64) * 256 + payloads[:, 2]
    brake, backward = (flags & 1) != 0, (flags & 2) != 0
    drive = np.where(pwm >= 1023, 0, 1024 - pwm)
    curve = motors.raw_drive, motors.raw_speed_m_s
    speed_m_s = np.where(brake, 0.0, np.interp(drive, *curve))
    magnitude: Floats = np.where(brake, 0.0, np.where(drive >= 1024, np.inf, np.interp(drive + 1, *curve)))
    side = _side(np.where(backward, -speed_m_s, speed_m_s), magnitude, backward, speed_m_s == 0.0, brake)
    return side, (flags < 4) & (pwm <= 1023) & (~brake | ((pwm == 1023) & ~backward))


def _side(speed_m_s: Floats, magnitude_m_s: Floats, backward: Flags, is_zero: Flags, stands: Flags) -> Side:
    low = np.where(backward | is_zero, -magnitude_m_s, speed_m_s) - _SLACK_M_S
    high = np.where(backward & ~is_zero, speed_m_s, magnitude_m_s) + _SLACK_M_S
    return Side(speed_m_s, low, high, stands)
