"""Pose of the robot by its encoders, from the states that a device gets."""

import math
from typing import NamedTuple

from hal.odometry import PlanePose
from kurt2rt.channel.protocol.state import State


class WheelPose(NamedTuple):
    """Pose since the device began, and the speeds of the newest step."""

    pose: PlanePose
    forward_m_s: float
    turn_rad_s: float


class Odometer:
    """Dead reckoning by the ways of both sides, which the robot sums up, so that a lost state loses no way."""

    def __init__(self) -> None:
        """Start at (0, 0, 0)."""
        self._pose = PlanePose()
        self._newest: State | None = None

    def update(self, state: State, track_m: float, period_s: float) -> WheelPose:
        """Return the pose after a state. A restarted robot goes on where it was.

        `track_m`: distance of the sides in m; `period_s`: duration of a tick in s.
        """
        before, self._newest = self._newest, state
        if before is None or before.boot != state.boot or state.tick <= before.tick:
            return WheelPose(self._pose, 0.0, 0.0)
        left_m, right_m = state.way_m[0] - before.way_m[0], state.way_m[1] - before.way_m[1]
        forward_m, turn_rad = (left_m + right_m) / 2, (right_m - left_m) / track_m
        moved = self._pose.moved(forward_m, turn_rad)
        self._pose = moved._replace(heading_rad=math.remainder(moved.heading_rad, math.tau))
        took_s = (state.tick - before.tick) * period_s
        return WheelPose(self._pose, forward_m / took_s, turn_rad / took_s)
