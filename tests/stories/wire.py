"""Commands to robots, read from the bytes that are sent to them, by code that shares nothing with the codecs."""

import math
import struct
from binascii import crc_hqx
from collections.abc import Callable
from typing import NamedTuple

from tests.stories.table import RobotKind

_SPEED_CM = 2
_SET_POINT = struct.Struct(">HhhH")
_BRAKE_PAYLOAD = bytes((0, 0, 0x01, 0x03, 0xFF, 0x01, 0x03, 0xFF))
"""RAW, both sides: brake, no drive (docs/the-robot.md#control-modes)."""
_TWIST = struct.Struct("<4s8xI10s2x6d")
"""TwistStamped as CDR: header, stamp, frame of the base with its length, speeds along and about three axes."""
_CDR, _FRAME = b"\0\1\0\0", b"base_link\0"
_HALF_TRACK_M = 0.08


class WheelCommand(NamedTuple):
    """Command of a message to the wheels."""

    left_m_s: float
    right_m_s: float
    brake: bool

    @property
    def standing(self) -> bool:
        """Return whether both sides are commanded to stand."""
        return self.left_m_s == 0.0 and self.right_m_s == 0.0


BRAKE = WheelCommand(0.0, 0.0, brake=True)


class Wire(NamedTuple):
    """Messages of one kind of robot."""

    robot: RobotKind
    decode: Callable[[bytes], WheelCommand | None]
    """Return the command of a payload; None if the robot or this guard does not use it."""
    range_ids: frozenset[int]
    """Identifiers of the messages that hold the range sensors."""
    bumpers_id: int | None = None
    """Identifier of the message whose first byte has the bits of the bumpers; None without bumpers."""


def decode_control(payload: bytes) -> WheelCommand | None:
    """Return the command of a CONTROL frame of KURT2."""
    if payload == _BRAKE_PAYLOAD:
        return BRAKE
    if len(payload) != _SET_POINT.size:
        return None
    mode, left_cm_s, right_cm_s, _ = _SET_POINT.unpack(payload)
    return WheelCommand(left_cm_s / 100.0, right_cm_s / 100.0, brake=False) if mode == _SPEED_CM else None


def words_of(line: bytes) -> list[bytes]:
    """Return the words of a line of the school robot; none if it is damaged (docs/other-robots.md)."""
    body, _, checksum = line.strip().rpartition(b"*")
    return body.split() if checksum == b"%04X" % crc_hqx(body, 0) else []


def decode_line(line: bytes) -> WheelCommand | None:
    """Return the command of a line to the school robot."""
    match words_of(line):
        case [b"drive", _, left_mm_s, right_mm_s]:
            return WheelCommand(int(left_mm_s) / 1000, int(right_mm_s) / 1000, brake=False)
        case [b"brake", _]:
            return BRAKE
        case _:
            return None


def decode_twist(payload: bytes) -> WheelCommand | None:
    """Return the command of a TwistStamped to the base; one of 0 is its brake."""
    if len(payload) != _TWIST.size:
        return None
    cdr, length, frame, forward_m_s, *others, turn_rad_s = _TWIST.unpack(payload)
    if (cdr, length, frame, any(others)) != (_CDR, len(_FRAME), _FRAME, False) or not math.isfinite(turn_rad_s):
        return None
    half_m_s = turn_rad_s * _HALF_TRACK_M
    return WheelCommand(forward_m_s - half_m_s, forward_m_s + half_m_s, forward_m_s == turn_rad_s == 0.0)


KURT2 = Wire("kurt2", decode_control, frozenset((5, 6, 7, 21, 22)), 10)  # docs/the-robot.md#messages
SCHOOL = Wire("school", decode_line, frozenset((0,)))
TURTLEBOT = Wire("turtlebot", decode_twist, frozenset((0,)))
