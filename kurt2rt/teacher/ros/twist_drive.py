"""Deadman switch of twists: the robot drives by hand only while they come, and only while this device teaches it."""

import math
from collections.abc import Callable
from typing import NamedTuple

from hal.robot import STANDSTILL, WheelSpeeds
from kurt2rt.core.message_fields import WireError
from kurt2rt.ros.messages import Twist
from kurt2rt.teacher.client.client import TeacherClient

LEASE_S = 0.25
"""Time after a twist in which the next one has to come; the robot itself waits 0.24 s for the device's messages."""


class TwistRefusedError(Exception):
    """A twist that the robot must not or cannot follow."""


class DriveLimits(NamedTuple):
    """Track in m and highest speed in m/s of the robot, by which twists become wheel speeds."""

    track_m: float
    max_m_s: float


def wheel_speeds(twist: Twist, limits: DriveLimits) -> WheelSpeeds:
    """Return the speeds of both sides for a twist in m/s and rad/s.

    Raises TwistRefusedError for a twist that the robot cannot drive exactly.
    """
    linear, angular = twist.linear, twist.angular
    values = (linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
    if not all(map(math.isfinite, values)):
        raise TwistRefusedError(f"a speed is not a finite number (got {', '.join(f'{each:g}' for each in values)})")
    if linear.y or linear.z or angular.x or angular.y:
        raise TwistRefusedError("the robot only drives along x and turns about z; leave the other speeds 0")
    half_m_s = angular.z * limits.track_m / 2
    left_m_s, right_m_s = linear.x - half_m_s, linear.x + half_m_s
    fastest_m_s = max(abs(left_m_s), abs(right_m_s))
    if fastest_m_s > limits.max_m_s:
        raise TwistRefusedError(
            f"one side would have to drive at {fastest_m_s:.2f} m/s, allowed is {limits.max_m_s:g}; send less"
        )
    return WheelSpeeds(left_m_s, right_m_s)


class TwistDrive:
    """Press of manual drive that twists begin, renew and end.

    A press that ended otherwise than by silence of the twists (a stop, another teacher, a lost state, a refused twist)
    does not begin again by twists that simply go on: they must cease for LEASE_S, or be 0 once.
    """

    def __init__(
        self, robot: TeacherClient, limits: DriveLimits, *, now: Callable[[], float], let_go: Callable[[], None]
    ) -> None:
        """Start without a press. `now`: monotonic clock in s; `let_go` ends the robot's press without waiting."""
        self._robot = robot
        self.limits = limits
        """Limits of the robot; set them again if another robot answers."""
        self._now = now
        self._let_go = let_go
        self._newest_s = -math.inf
        self._on = False
        self._blocked = False
        self.refused = 0
        """Number of twists that were refused."""
        self.trouble = ""
        """Reason that the newest twists do not drive, in a sentence; empty if they do or none come."""

    @property
    def on(self) -> bool:
        """True while twists drive the robot."""
        return self._on and self._robot.pressing

    def on_twist(self, twist: Twist, arrived_s: float) -> None:
        """Drive by a twist, or refuse it, which ends a press that is on. `arrived_s`: its time by `now`."""
        self.poll()
        try:
            speeds = wheel_speeds(twist, self.limits)
            self._require_teacher()
        except TwistRefusedError as error:
            self.refuse(str(error), arrived_s)
            return
        self._newest_s = arrived_s
        if speeds == STANDSTILL and not self._on:
            self._unblock()
        elif not self._blocked:
            self._press(speeds, arrived_s)

    def refuse(self, why: str, arrived_s: float) -> None:
        """Refuse what came instead of a twist, which ends a press that is on. `arrived_s`: its time by `now`."""
        self._newest_s = arrived_s
        self.refused += 1
        self._blocked = True
        self.trouble = why
        if self._on:
            self._on = False
            self._let_go()

    def poll(self) -> None:
        """End the press if the twists ceased; call it 50 times a second."""
        if self._on and not self._robot.pressing:
            self._note_end()
        if self._now() - self._newest_s < LEASE_S:
            return
        self._unblock()
        if self._on:
            self._on = False
            self._let_go()

    def _press(self, speeds: WheelSpeeds, arrived_s: float) -> None:
        try:
            pressing = self._robot.press(*speeds)
        except WireError as error:  # faster than the channel carries, for a robot that may drive faster
            self.refuse(str(error), arrived_s)
            return
        self._on = pressing
        self.trouble = ""
        if not pressing:
            self._note_end()

    def _unblock(self) -> None:
        self._blocked = False
        self.trouble = ""

    def _require_teacher(self) -> None:
        state = self._robot.state
        teacher = None if state is None else state.teacher
        if teacher != self._robot.name:
            whose = "the robot has no teacher" if teacher is None else f"{teacher} teaches the robot"
            raise TwistRefusedError(f"{whose}, and only its teacher drives it; call the service take first")

    def _note_end(self) -> None:
        """Note that robot or link ended the press, or kept it from beginning."""
        self._on, self._blocked = False, True
        refusal = self._robot.refusal
        self.trouble = "the press is over" if refusal is None else refusal.text
