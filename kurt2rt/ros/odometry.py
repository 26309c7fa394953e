"""Odometry of a base with two wheels: messages as wheel ticks, and poses as messages."""

import math
from typing import NamedTuple

import numpy as np

from hal.numerics import cos_sin, round_portable
from hal.odometry import PlanePose
from hal.robot_settings import GeometrySettings
from kurt2rt.ros.messages import (
    Header,
    InvalidMessageError,
    Odometry,
    Point,
    Pose,
    PoseWithCovariance,
    Quaternion,
    Twist,
    TwistWithCovariance,
    Vector3,
    to_seconds,
    to_time,
)

_JUMP_FACTOR = 3.0
"""Faster than this many times its highest speed, a robot was set to another place."""
_NO_COVARIANCE = np.zeros(36)


class Turned(NamedTuple):
    """Ticks of both wheels, forward positive, and the time that they took; a time of 0 says nothing about speeds."""

    left_ticks: int
    right_ticks: int
    duration_s: float


_NOTHING_KNOWN = Turned(0, 0, 0.0)


class TurnedWheels:
    """Ticks between the messages of one odometry; a message that was lost takes none along."""

    def __init__(self, geometry: GeometrySettings, fastest_m_s: float) -> None:
        """Count ticks of wheels of this geometry, whose robot drives at most at `fastest_m_s`."""
        self._geometry, self._jump_m_s = geometry, _JUMP_FACTOR * fastest_m_s
        self._last: PlanePose | None = None
        self._last_s = 0.0
        self._left_carry = self._right_carry = 0.0

    def forget(self) -> None:
        """Count the next message as the first one, as after the clock of the stamps was set."""
        self._last = None

    def update(self, odometry: Odometry) -> Turned:
        """Return the ticks since the message before.

        Raises kurt2rt.ros.messages.InvalidMessageError for a pose that makes no sense, or a message that is not newer.
        """
        position, orientation = odometry.pose.pose.position, odometry.pose.pose.orientation
        pose = PlanePose(position.x, position.y, 2 * math.atan2(orientation.z, orientation.w))
        stamp_s = to_seconds(odometry.header.stamp)
        if not all(map(math.isfinite, pose)):
            raise InvalidMessageError("Odometry: the pose is not a number")
        pose = pose._replace(heading_rad=round_portable(pose.heading_rad))
        last, elapsed_s = self._last, stamp_s - self._last_s
        if last is not None and elapsed_s <= 0:
            raise InvalidMessageError("Odometry: the stamp is not newer than the one before")
        self._last, self._last_s = pose, stamp_s
        if last is None or math.dist(last[:2], pose[:2]) > self._jump_m_s * elapsed_s:
            return _NOTHING_KNOWN
        turn_rad = math.remainder(pose.heading_rad - last.heading_rad, math.tau)
        middle_rad = last.heading_rad + turn_rad / 2
        cos, sin = cos_sin(middle_rad)
        forward_m = (pose.x_m - last.x_m) * cos + (pose.y_m - last.y_m) * sin
        half_m, tick_m = turn_rad * self._geometry.effective_track_m / 2, self._geometry.metres_per_tick
        left = (forward_m - half_m) / tick_m + self._left_carry
        right = (forward_m + half_m) / tick_m + self._right_carry
        self._left_carry, self._right_carry = left - round(left), right - round(right)
        return Turned(round(left), round(right), elapsed_s)


def odometry_message(pose: PlanePose, forward_m_s: float, turn_rad_s: float, stamp_s: float) -> Odometry:
    """Return the message of a pose in the frame `odom` and of speeds in m/s and rad/s, at a time in s."""
    cos, sin = cos_sin(pose.heading_rad / 2)
    place = Pose(Point(pose.x_m, pose.y_m, 0.0), Quaternion(0.0, 0.0, sin, cos))
    twist = Twist(Vector3(forward_m_s, 0.0, 0.0), Vector3(0.0, 0.0, turn_rad_s))
    return Odometry(
        Header(to_time(stamp_s), "odom"),
        "base_footprint",
        PoseWithCovariance(place, _NO_COVARIANCE),
        TwistWithCovariance(twist, _NO_COVARIANCE),
    )
