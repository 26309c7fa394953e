"""CONTROL frame: set points, brake and system commands of the firmware (docs/the-robot.md#control-modes).

Only `hal.guard` may call the encoders: the first thing every set point meets is the guard.
"""

import math
import struct
from bisect import bisect_left
from enum import IntEnum
from typing import NamedTuple

from hal.bus import CONTROL_ID
from hal.codec import InvalidFrameError
from hal.frame import Frame
from hal.kurt2_settings import Kurt2MotorSettings, SpeedMode
from hal.robot import WheelSpeeds

FULL_DRIVE = 1024
"""PWM period: drive = 1024 - PWM, for PWM on the wire is inverted (0 is full drive)."""
NO_DRIVE_PWM = 1023
_BACKWARD, _BRAKE = 0b10, 0b01
_KEEP = 1
_ROUNDING = 1e-6  # 0.29 m/s is 28.999999999999996 cm/s; truncation is meant for fractions, not for that

_MODE = struct.Struct(">H")
_RAW = struct.Struct(">HBHBH")
_SPEED = struct.Struct(">HhhH")
_SYSTEM = struct.Struct(">Hi2x")


class Mode(IntEnum):
    """First word of a CONTROL frame: the mode of a set point, or a system command of the firmware."""

    RAW = 0x0000
    SPEED = 0x0001
    SPEED_CM = 0x0002
    ACTUATOR_ON = 0xFF00
    ACTUATOR_OFF = 0xFF01
    CALIBRATE_GYRO = 0xFF02
    RESET_GYRO = 0xFF03
    RESET_SSC = 0xFF04
    UPDATE_ANGLE = 0xFF05
    MC_RESET = 0xFFFF


class RawSide(NamedTuple):
    """One side in RAW mode: drive from 0 to 1024, direction and brake."""

    drive: int
    backward: bool = False
    brake: bool = False


class RawControl(NamedTuple):
    """CONTROL frame of mode RAW: drive and brake of each side without a speed loop; every brake is one."""

    left: RawSide
    right: RawSide
    mode: Mode = Mode.RAW

    def wheel_speeds(self, motors: Kurt2MotorSettings) -> WheelSpeeds:
        """Return the no-load speeds in m/s by the robot's curve; 0 with the brake on."""
        return WheelSpeeds(_raw_speed_m_s(self.left, motors), _raw_speed_m_s(self.right, motors))


class SpeedControl(NamedTuple):
    """Set points of the controller's speed loops: cm/s in SPEED_CM, percent of full_speed_m_s in SPEED."""

    mode: Mode
    left: int
    right: int
    yaw_rate_rad_s: float = 0.0
    keep: bool = True

    def wheel_speeds(self, motors: Kurt2MotorSettings) -> WheelSpeeds:
        """Return the set points in m/s."""
        if self.mode == Mode.SPEED_CM:
            return WheelSpeeds(self.left / 100.0, self.right / 100.0)
        return WheelSpeeds(self.left * motors.full_speed_m_s / 100.0, self.right * motors.full_speed_m_s / 100.0)


class SystemControl(NamedTuple):
    """CONTROL frame that drives no wheel: a system command. `angle_urad` belongs to UPDATE_ANGLE."""

    mode: Mode
    angle_urad: int = 0


Control = RawControl | SpeedControl | SystemControl

_BRAKE_BOTH = RawControl(RawSide(0, brake=True), RawSide(0, brake=True))


def set_point(mode: SpeedMode, wheel_speeds: WheelSpeeds, motors: Kurt2MotorSettings) -> RawControl | SpeedControl:
    """Return the set point of finite wheel speeds, truncated toward zero and limited to full percent or drive."""
    left_m_s, right_m_s = wheel_speeds
    if mode is SpeedMode.SPEED_CM:
        return SpeedControl(Mode.SPEED_CM, _truncated(left_m_s * 100.0), _truncated(right_m_s * 100.0))
    if mode is SpeedMode.SPEED:
        percent_s_m = 100.0 / motors.full_speed_m_s
        left, right = _truncated(left_m_s * percent_s_m), _truncated(right_m_s * percent_s_m)
        return SpeedControl(Mode.SPEED, max(-100, min(100, left)), max(-100, min(100, right)))
    return RawControl(_raw_side(left_m_s, motors), _raw_side(right_m_s, motors))


def control_frame(control: Control) -> Frame:
    """Return the CONTROL frame of a control value. Raises ValueError if a number does not fit its field."""
    try:
        return Frame(CONTROL_ID, _payload(control))
    except struct.error as error:
        raise ValueError(f"CONTROL cannot carry {control}: {error}") from error


def encode_control(mode: SpeedMode, wheel_speeds: WheelSpeeds, motors: Kurt2MotorSettings) -> Frame:
    """Return the CONTROL frame of finite wheel speeds; yaw 0 and keep 1 always (docs/the-robot.md#yaw-and-keep).

    Raises ValueError for a speed in SPEED_CM that does not fit its field.
    """
    return control_frame(set_point(mode, wheel_speeds, motors))


def encode_brake() -> Frame:
    """Return RAW without drive, brake on both sides (docs/the-robot.md#emergency-stop)."""
    return control_frame(_BRAKE_BOTH)


def decode_control(data: bytes | bytearray) -> Control:
    """Return the value of a CONTROL payload. Raises InvalidFrameError for an unknown mode or less than 8 bytes."""
    if len(data) < 8:
        raise InvalidFrameError(f"CONTROL: {len(data)} bytes, needs 8")
    (number,) = _MODE.unpack_from(data)
    try:
        mode = Mode(number)
    except ValueError:
        raise InvalidFrameError(f"CONTROL: mode 0x{number:04X} is unknown") from None
    if mode is Mode.SPEED_CM or mode is Mode.SPEED:
        _, left, right, rest = _SPEED.unpack_from(data)
        if mode is Mode.SPEED:
            return SpeedControl(mode, left, right)
        yaw_rate_rad_s = (rest >> 2) * math.pi / 100.0
        return SpeedControl(mode, left, right, -yaw_rate_rad_s if rest & 0b10 else yaw_rate_rad_s, bool(rest & _KEEP))
    if mode is Mode.RAW:
        _, left_flags, left_pwm, right_flags, right_pwm = _RAW.unpack_from(data)
        return RawControl(_raw_side_of(left_flags, left_pwm), _raw_side_of(right_flags, right_pwm))
    return SystemControl(mode, _SYSTEM.unpack_from(data)[1] if mode is Mode.UPDATE_ANGLE else 0)


def _payload(control: Control) -> bytes:
    if isinstance(control, SpeedControl):
        rest = 0
        if control.mode == Mode.SPEED_CM:
            yaw = int(abs(control.yaw_rate_rad_s) * 100.0 / math.pi + _ROUNDING)
            rest = (yaw << 2) | (0b10 if control.yaw_rate_rad_s < 0 else 0) | (_KEEP if control.keep else 0)
        return _SPEED.pack(control.mode, control.left, control.right, rest)
    if isinstance(control, RawControl):
        left, right = control.left, control.right
        return _RAW.pack(control.mode, _flags(left), _pwm(left), _flags(right), _pwm(right))
    return _SYSTEM.pack(control.mode, control.angle_urad)


def _truncated(value: float) -> int:
    return int(value + math.copysign(_ROUNDING, value))


def _flags(side: RawSide) -> int:
    return (_BACKWARD if side.backward else 0) | (_BRAKE if side.brake else 0)


def _pwm(side: RawSide) -> int:
    return min(NO_DRIVE_PWM, FULL_DRIVE - side.drive)


def _raw_side_of(flags: int, pwm: int) -> RawSide:
    drive = 0 if pwm >= NO_DRIVE_PWM else FULL_DRIVE - pwm
    return RawSide(drive, bool(flags & _BACKWARD), bool(flags & _BRAKE))


def _raw_side(speed_m_s: float, motors: Kurt2MotorSettings) -> RawSide:
    """Invert the no-load curve: return the least drive that gives the speed, interpolated, at most the curve's end."""
    speeds, drives = motors.raw_speed_m_s, motors.raw_drive
    wanted_m_s = min(abs(speed_m_s), speeds[-1])
    upper = bisect_left(speeds, wanted_m_s)
    if upper == 0:  # 0, or slower than the motor can turn
        return RawSide(0, brake=True)  # nothing regulates in RAW: without the brake the robot would roll on
    lower = upper - 1
    share = (wanted_m_s - speeds[lower]) / (speeds[upper] - speeds[lower])
    return RawSide(_truncated(drives[lower] + share * (drives[upper] - drives[lower])), speed_m_s < 0.0)


def _raw_speed_m_s(side: RawSide, motors: Kurt2MotorSettings) -> float:
    speeds, drives = motors.raw_speed_m_s, motors.raw_drive
    if side.brake or side.drive <= drives[0]:
        speed_m_s = 0.0 if side.brake else speeds[0]
    elif side.drive >= drives[-1]:
        speed_m_s = speeds[-1]
    else:
        upper = bisect_left(drives, side.drive)
        share = (side.drive - drives[upper - 1]) / (drives[upper] - drives[upper - 1])
        speed_m_s = speeds[upper - 1] + share * (speeds[upper] - speeds[upper - 1])
    return -speed_m_s if side.backward else speed_m_s
