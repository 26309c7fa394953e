"""Runtime's end of the topics of a base: /scan and /odom in, /cmd_vel out (hal.robot_link.RobotLink)."""

import math
from collections.abc import Sequence

import numpy as np

from hal.bus import BusError
from hal.robot import STANDSTILL, WheelSpeeds
from hal.robot_link import AlarmReport, ForeignCommandReport, NoticeReport, RangeReport, Report, WheelReport
from kurt2rt.robots.turtlebot.sectors import Sectors
from kurt2rt.robots.turtlebot.settings import TurtlebotSettings
from kurt2rt.ros.diagnostics import DiagnosticErrors
from kurt2rt.ros.inbox import Clock, Inbox, MachineClock
from kurt2rt.ros.messages import DiagnosticArray, LaserScan, Odometry
from kurt2rt.ros.odometry import Turned, TurnedWheels
from kurt2rt.ros.port import RosPort
from kurt2rt.ros.topic import topic_of
from kurt2rt.ros.twist import Twists

_LOOK_S = 1.0
"""Time between two looks at the stamps while no message counts."""
_HANGS_AFTER_M = 0.3
_HANGS = f"the lidar hangs, its scans stayed equal while the wheels drove {_HANGS_AFTER_M:g} m; start its driver again"


class TurtlebotLink:
    """Runtime's link to a base over ROS 2 topics; without a connection it counts as lost."""

    remedy = "check the network, the bridge or router, and the robot's bringup"
    unconfirmed = 0

    def __init__(self, settings: TurtlebotSettings, port: RosPort, name: str, clock: Clock | None = None) -> None:
        """Own `port`, called `name` in messages. Raises hal.bus.BusError."""
        self.name, self._port, self._clock = name, port, clock or MachineClock()
        topics, self._twists = settings.ros, Twists(settings.twist, settings)
        cmd_vel = topic_of(topics.cmd_vel, self._twists.message_class)
        diagnostics = topic_of(topics.diagnostics, DiagnosticArray)
        self._scans = Inbox(port, topic_of(topics.scan, LaserScan), LaserScan, self._clock, one_sender=True)
        self._odometry = Inbox(port, topic_of(topics.odom, Odometry), Odometry, self._clock, one_sender=True)
        self._diagnostics = Inbox(port, diagnostics, DiagnosticArray, self._clock)
        self._foreign = Inbox(port, cmd_vel, self._twists.message_class, self._clock)
        self._publisher = port.publisher(cmd_vel)
        self._sectors = Sectors(settings)
        self._wheels = TurnedWheels(settings.geometry, settings.motors.maximum_speed_m_s)
        self._errors = DiagnosticErrors(topics.stops_on_errors_of)
        self._metres_per_tick = settings.geometry.metres_per_tick
        self._last_ranges = b""
        self._unchanged_m = 0.0
        """Way of the wheels since the ranges changed."""
        self._hangs = False
        self._odometry_jumps = 0
        self._told_error = self._told_notice = ""
        self._looked_at_s = -math.inf

    @property
    def junk(self) -> int:
        """Messages so far that could not be read."""
        return sum(inbox.junk for inbox in (self._scans, self._odometry, self._diagnostics, self._foreign))

    def receive(self, now_s: float) -> Sequence[Report]:
        """Return all reports that arrived; `now_s` on the runtime's clock.

        Raises hal.bus.BusError while nothing is connected.
        """
        reports: list[Report] = []
        for each in self._scans.take(lambda scan, age_s: self._ranges(scan, now_s - age_s)):
            reports += each
        reports += self._odometry.take(lambda odom, age_s: WheelReport(now_s - age_s, *self._turned(odom)))
        reports += self._foreign.take(lambda _, age_s: ForeignCommandReport(now_s - age_s))
        errors = [self._errors.update(array) for array in self._diagnostics.take(lambda array, _: array)]
        self._require_link()
        # After the check: a report that is lost with the link would not be told again.
        for error in (*errors, _HANGS if self._hangs else self._errors.text):
            if error != self._told_error:
                self._told_error = error
                reports.append(AlarmReport(now_s, error))
        if reports or now_s - self._looked_at_s >= _LOOK_S:
            self._looked_at_s = now_s
            notice = self._scans.notice or self._odometry.notice
            if notice != self._told_notice:
                self._told_notice = notice
                reports.append(NoticeReport(now_s, notice))
        return reports

    def applied(self, speeds: WheelSpeeds) -> WheelSpeeds:
        """Return set points in m/s as the base cuts its twist off, never above those that were given."""
        return self._twists.to_wheels(self._twists.of_wheels(speeds))

    def send(self, speeds: WheelSpeeds) -> None:
        """Send finite set points in m/s. Raises hal.bus.BusError."""
        self._require_link()
        self._publish(speeds)

    def brake(self) -> None:
        """Send a twist of 0, also while nothing is connected. Raises hal.bus.BusError."""
        self._publish(STANDSTILL)

    def forget_unconfirmed(self) -> None:
        """Do nothing: zenoh does not tell of messages that are not yet carried."""

    def reopen(self) -> None:
        """Check that the session found the base again. Raises hal.bus.BusError while it did not."""
        self._require_link()
        self._wheels.forget()
        self._scans.forget_clock()
        self._odometry.forget_clock()
        self._odometry_jumps = 0

    def close(self) -> None:
        """Close the session; may be called twice."""
        self._port.close()

    def _ranges(self, scan: LaserScan, at_s: float) -> list[Report]:
        counts, seen = self._sectors.counts(scan), scan.ranges.tobytes()
        # A simulated lidar without noise repeats itself while the robot stands, and any lidar in an empty hall.
        if seen != self._last_ranges or not np.isfinite(scan.ranges).any():
            self._last_ranges, self._unchanged_m = seen, 0.0
        self._hangs = self._unchanged_m >= _HANGS_AFTER_M
        # A sector in which no ray measured anything reports nothing: its last reading grows old.
        return [RangeReport(at_s, first, (value,)) for first, value in enumerate(counts) if value is not None]

    def _turned(self, odometry: Odometry) -> Turned:
        if self._odometry.jumps != self._odometry_jumps:
            self._odometry_jumps = self._odometry.jumps
            self._wheels.forget()
        turned = self._wheels.update(odometry)
        self._unchanged_m += (abs(turned.left_ticks) + abs(turned.right_ticks)) / 2 * self._metres_per_tick
        return turned

    def _publish(self, speeds: WheelSpeeds) -> None:
        self._publisher.publish(self._twists.message(self._twists.of_wheels(speeds), self._clock.wall_s()))

    def _require_link(self) -> None:
        if not self._port.connected:
            raise BusError("no robot is connected", where=self.name, do=self.remedy)
