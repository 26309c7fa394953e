"""Runtime's end of the topics of a base: /scan and /odom in, /cmd_vel out (hal.robot_link.RobotLink)."""

import math
import time
from collections.abc import Sequence
from typing import NamedTuple

from hal.bus import BusError
from hal.robot import STANDSTILL, WheelSpeeds
from hal.robot_link import ForeignCommandReport, RangeReport, Report, WheelReport
from kurt2rt.robots.turtlebot.sectors import Sectors
from kurt2rt.robots.turtlebot.settings import TurtlebotSettings
from kurt2rt.ros.inbox import Clock, Inbox
from kurt2rt.ros.messages import (
    DiagnosticArray,
    Header,
    InvalidMessageError,
    LaserScan,
    Message,
    Odometry,
    Twist,
    TwistStamped,
    Vector3,
    to_seconds,
    to_time,
)
from kurt2rt.ros.port import RosConnectionError, RosPort
from kurt2rt.ros.topic import topic_of

_JUMP_FACTOR = 3.0
"""Odometry faster than this many times the highest speed was set to another place."""


_ROUNDING_M_S = 1e-4


class MachineClock:
    """Clocks of this machine (kurt2rt.ros.inbox.Clock)."""

    now_s = staticmethod(time.monotonic)
    wall_s = staticmethod(time.time)


class _Place(NamedTuple):
    stamp_s: float
    x_m: float
    y_m: float
    heading_rad: float


class TurtlebotLink:
    """Link over topics; lost while nothing is connected, or while /diagnostics tells an error of the base."""

    remedy = "check the network, the bridge or router, and the robot's bringup"

    def __init__(self, settings: TurtlebotSettings, port: RosPort, name: str, clock: Clock | None = None) -> None:
        """Own `port`, called `name` in messages. Raises hal.bus.BusError."""
        self.name = name
        self.unconfirmed = 0
        topics, self._settings, self._port = settings.ros, settings, port
        self._clock = clock or MachineClock()
        twist: type[Message] = TwistStamped if topics.stamped_cmd_vel else Twist
        cmd_vel = topic_of(topics.cmd_vel, twist)
        try:
            self._scans = Inbox(port, topic_of(topics.scan, LaserScan), LaserScan, self._clock)
            self._odometry = Inbox(port, topic_of(topics.odom, Odometry), Odometry, self._clock)
            self._diagnostics = Inbox(port, topic_of(topics.diagnostics, DiagnosticArray), DiagnosticArray, self._clock)
            self._foreign: Inbox[Message] = Inbox(port, cmd_vel, twist, self._clock)
            self._publisher = port.publisher(cmd_vel)
        except RosConnectionError as error:
            raise self._lost(str(error)) from error
        self._sectors = Sectors(settings)
        self._rejected = 0
        self._place: _Place | None = None
        self._ticks_carry = (0.0, 0.0)
        self._errors: dict[str, str] = {}

    @property
    def junk(self) -> int:
        """Messages so far that could not be read."""
        inboxes = (self._scans, self._odometry, self._diagnostics, self._foreign)
        return self._rejected + sum(inbox.junk for inbox in inboxes)

    def receive(self, now_s: float) -> Sequence[Report]:
        """Return all reports that arrived; `now_s` on the runtime's clock.

        Raises hal.bus.BusError while nothing is connected or the base tells an error.
        """
        reports: list[Report] = []
        for scan, age_s in self._scans.take():
            reports += self._ranges(scan, now_s - age_s)
        for odometry, age_s in self._odometry.take():
            reports += self._wheels(odometry, now_s - age_s)
        reports += [ForeignCommandReport(now_s - arrived.age_s) for arrived in self._foreign.take()]
        for array, _ in self._diagnostics.take():
            self._note_errors(array)
        self._require_link()
        return reports

    def applied(self, speeds: WheelSpeeds) -> WheelSpeeds:
        """Return set points in m/s as the base cuts its twist off, never above those that were given."""
        forward_m_s, turn_rad_s = self._twist(speeds)
        half_m_s = turn_rad_s * self._settings.geometry.effective_track_m / 2
        return WheelSpeeds(forward_m_s - half_m_s, forward_m_s + half_m_s)

    def send(self, speeds: WheelSpeeds) -> None:
        """Send finite set points in m/s. Raises hal.bus.BusError."""
        self._require_link()
        forward_m_s, turn_rad_s = self._twist(speeds)
        twist = Twist(Vector3(forward_m_s, 0.0, 0.0), Vector3(0.0, 0.0, turn_rad_s))
        message: Message = twist
        if self._settings.ros.stamped_cmd_vel:
            message = TwistStamped(Header(to_time(self._clock.wall_s()), "base_link"), twist)
        try:
            self._publisher.publish(message)
        except RosConnectionError as error:
            raise self._lost(str(error)) from error

    def brake(self) -> None:
        """Send a twist of 0. Raises hal.bus.BusError."""
        self.send(STANDSTILL)

    def forget_unconfirmed(self) -> None:
        """Do nothing: zenoh does not tell of messages that are not yet carried."""

    def reopen(self) -> None:
        """Check that the session found the base again. Raises hal.bus.BusError while it did not."""
        self._require_link()
        self._place = None

    def close(self) -> None:
        """Close the session; may be called twice."""
        self._port.close()

    def _ranges(self, scan: LaserScan, at_s: float) -> list[Report]:
        try:
            counts = self._sectors.counts(scan)
        except InvalidMessageError:
            self._rejected += 1
            return []
        known = tuple(value for value in counts if value is not None)
        if len(known) == len(counts):
            return [RangeReport(at_s, 0, known)]
        # A sector in which no ray measured anything reports nothing: its last reading grows old.
        return [RangeReport(at_s, first, (value,)) for first, value in enumerate(counts) if value is not None]

    def _wheels(self, odometry: Odometry, at_s: float) -> list[Report]:
        position, orientation = odometry.pose.pose.position, odometry.pose.pose.orientation
        heading_rad = 2 * math.atan2(orientation.z, orientation.w)
        place = _Place(to_seconds(odometry.header.stamp), position.x, position.y, heading_rad)
        last = self._place
        if not all(map(math.isfinite, place)) or (last is not None and 0 <= last.stamp_s - place.stamp_s < 1.0):
            self._rejected += 1  # an old message again tells nothing of now
            return []
        self._place = place
        ticks = None if last is None else self._ticks_between(last, place)
        if last is None or ticks is None:
            return [WheelReport(at_s, 0, 0, 0.0)]
        return [WheelReport(at_s, *ticks, place.stamp_s - last.stamp_s)]

    def _ticks_between(self, last: _Place, place: _Place) -> tuple[int, int] | None:
        """Return the ticks of both sides on the way between two places; None if the odometry jumped."""
        turn_rad = math.remainder(place.heading_rad - last.heading_rad, math.tau)
        middle_rad = last.heading_rad + turn_rad / 2
        dx_m, dy_m = place.x_m - last.x_m, place.y_m - last.y_m
        forward_m = dx_m * math.cos(middle_rad) + dy_m * math.sin(middle_rad)
        elapsed_s, fastest_m_s = place.stamp_s - last.stamp_s, self._settings.motors.maximum_speed_m_s
        if elapsed_s <= 0 or math.hypot(dx_m, dy_m) > _JUMP_FACTOR * fastest_m_s * elapsed_s:
            return None
        geometry = self._settings.geometry
        half_m = turn_rad * geometry.effective_track_m / 2
        sides_m = (forward_m - half_m, forward_m + half_m)
        exact = [
            side_m / geometry.metres_per_tick + carry for side_m, carry in zip(sides_m, self._ticks_carry, strict=True)
        ]
        left, right = map(round, exact)
        self._ticks_carry = (exact[0] - left, exact[1] - right)
        return left, right

    def _twist(self, speeds: WheelSpeeds) -> tuple[float, float]:
        """Return forward speed in m/s and turn in rad/s, towards 0 to whole steps of the base."""
        topics, (left_m_s, right_m_s) = self._settings.ros, speeds
        half_track_m = self._settings.geometry.effective_track_m / 2
        turn_rad_s = (right_m_s - left_m_s) / 2 / half_track_m
        turn_rad_s = max(-topics.maximum_turn_rad_s, min(topics.maximum_turn_rad_s, turn_rad_s))
        forward = _whole_steps((left_m_s + right_m_s) / 2, topics.linear_step_m_s)
        turn = _whole_steps(turn_rad_s, topics.angular_step_rad_s)
        # A turn that is cut off makes the inner side quicker, so the robot may have to drive a step slower.
        for less_forward, less_turn in ((0, 0), (1, 0), (0, 1), (1, 1)):
            forward_m_s = _reduced(forward, less_forward) * topics.linear_step_m_s
            turn_rad_s = _reduced(turn, less_turn) * topics.angular_step_rad_s
            half_m_s = turn_rad_s * half_track_m
            if (
                abs(forward_m_s - half_m_s) <= abs(left_m_s) + _ROUNDING_M_S
                and abs(forward_m_s + half_m_s) <= abs(right_m_s) + _ROUNDING_M_S
            ):
                return forward_m_s, turn_rad_s
        return 0.0, 0.0

    def _note_errors(self, array: DiagnosticArray) -> None:
        for status in array.status:
            if status.name.startswith(self._settings.ros.stops_on_errors_of):
                self._errors.pop(status.name, None)
                if status.level == status.ERROR:
                    self._errors[status.name] = status.message

    def _require_link(self) -> None:
        if not self._port.connected:
            raise self._lost("no robot is connected")
        for name, message in self._errors.items():
            raise self._lost(f"{name} tells an error: {message}")

    def _lost(self, what: str) -> BusError:
        return BusError(what, where=self.name, do=self.remedy)


def _whole_steps(value: float, step: float) -> int:
    """Return a value towards 0 in whole steps; one that is short of a step by rounding alone counts as a step."""
    return math.trunc(value / step + math.copysign(0.001, value))


def _reduced(steps: int, by: int) -> int:
    return steps - by if steps > 0 else min(0, steps + by)
