"""Simulated base: its electronics at the other end of the topics, in memory or over zenoh."""

import math
from collections.abc import Sequence

import numpy as np

from hal.robot_link import RobotLink
from hal.robot_settings import RobotSettings
from kurt2rt.robots.turtlebot.lidar import ScanReadings, scan_message
from kurt2rt.robots.turtlebot.link import TurtlebotLink
from kurt2rt.robots.turtlebot.settings import TurtlebotSettings, require_turtlebot
from kurt2rt.ros.inbox import Clock, Inbox
from kurt2rt.ros.messages import (
    Header,
    LaserScan,
    Message,
    Odometry,
    Point,
    Pose,
    PoseWithCovariance,
    Quaternion,
    Twist,
    TwistStamped,
    TwistWithCovariance,
    Vector3,
    to_time,
)
from kurt2rt.ros.port import LocalTopics, RosPort
from kurt2rt.ros.topic import topic_of
from simbridge.controller.controller import MOTORS_BRAKED, MotorCommands
from simbridge.robot.body import Body
from simbridge.robot.wheels import Wheels
from simbridge.simulated_link import InstantLink

_ORIGIN = Vector3(0.0, 0.0, 0.0)
_NO_COVARIANCE = np.zeros(36)


class SimulatedClock:
    """Clock that the electronics advance (kurt2rt.ros.inbox.Clock); a robot in memory stamps by it too."""

    def __init__(self) -> None:
        self.time_s = 0.0

    def now_s(self) -> float:
        """Return the simulated time in s."""
        return self.time_s

    def wall_s(self) -> float:
        """Return the time of stamps in s; 0 would mean none."""
        return 1.0 + self.time_s


class TurtlebotElectronics:
    """Electronics of a base (simbridge.controller.controller.Controller): it obeys /cmd_vel and sends /odom and /scan.

    It stops without /cmd_vel for the time of its watchdog, which a real TurtleBot3 does not (docs/turtlebot.md).
    """

    crashed = False

    def __init__(self, settings: TurtlebotSettings, port: RosPort, clock: Clock) -> None:
        """Use `port`, and stamp by `clock`. Raises kurt2rt.ros.port.RosConnectionError."""
        topics, self._settings, self._clock = settings.ros, settings, clock
        twist: type[Message] = TwistStamped if topics.stamped_cmd_vel else Twist
        self._inbox: Inbox[Message] = Inbox(port, topic_of(topics.cmd_vel, twist), twist, clock)
        self._scan = port.publisher(topic_of(topics.scan, LaserScan))
        self._odom = port.publisher(topic_of(topics.odom, Odometry))
        self._fresh: ScanReadings | None = None
        self._watchdog_cycles = round(settings.motors.controller_watchdog_s / settings.cycle_s)
        self._odometry_cycles = round(settings.odometry_period_s / settings.cycle_s)
        self.power_cycle()

    def power_cycle(self) -> None:
        """Switch off and on: odometry begins at its origin."""
        self.commands = MOTORS_BRAKED
        self._silent_cycles = self._watchdog_cycles
        self._cycles = self._left_ticks = self._right_ticks = self.control_frames = 0
        self._x_m = self._y_m = self._heading_rad = 0.0

    @property
    def watchdog_expired(self) -> bool:
        """Return whether no valid /cmd_vel has arrived for the watchdog's time."""
        return self._silent_cycles >= self._watchdog_cycles

    @property
    def junk_frames(self) -> int:
        """Number of twists that could not be read."""
        return self._inbox.junk

    @property
    def state(self) -> tuple[int, ...]:
        """Inputs of the next cycle besides the present commands, for the state hash."""
        return self._silent_cycles, self._cycles, self._left_ticks, self._right_ticks

    def receive(self) -> None:
        """Run the first half of a cycle: obey the twists that arrived."""
        self._silent_cycles += 1
        for message, _ in self._inbox.take():
            twist = message.twist if isinstance(message, TwistStamped) else message
            assert isinstance(twist, Twist)
            forward_m_s, turn_rad_s = twist.linear.x, twist.angular.z
            if math.isfinite(forward_m_s) and math.isfinite(turn_rad_s):
                self.commands = self._commands_of(forward_m_s, turn_rad_s)
                self._silent_cycles = 0
                self.control_frames += 1
        if self.watchdog_expired:
            self.commands = MOTORS_BRAKED

    def update_readings(self, fresh: Sequence[int], counts: Sequence[int]) -> None:
        """Apply a new scan: `counts` of the lidar's sectors come with its ranges."""
        if fresh and isinstance(counts, ScanReadings):
            self._fresh = counts

    def send(self, left_ticks: int, right_ticks: int, bumpers: int) -> None:  # noqa: ARG002 - it has no bumpers
        """Run the second half of a cycle: send a new scan, and odometry when it is due."""
        self._left_ticks += left_ticks
        self._right_ticks += right_ticks
        self._cycles += 1
        if isinstance(self._clock, SimulatedClock):
            self._clock.time_s += self._settings.cycle_s
        if self._fresh is not None:
            self._scan.publish(scan_message(self._settings, self._fresh.ranges_m, self._clock.wall_s()))
            self._fresh = None
        if self._cycles % self._odometry_cycles == 0:
            self._odom.publish(self._next_odometry())

    def _commands_of(self, forward_m_s: float, turn_rad_s: float) -> MotorCommands:
        """Return commands by the base's own limits, which cut off as its firmware does."""
        topics, fastest_m_s = self._settings.ros, self._settings.motors.maximum_speed_m_s
        forward_m_s = max(-fastest_m_s, min(fastest_m_s, forward_m_s))
        turn_rad_s = max(-topics.maximum_turn_rad_s, min(topics.maximum_turn_rad_s, turn_rad_s))
        half_m_s = turn_rad_s * self._settings.geometry.effective_track_m / 2
        if forward_m_s == half_m_s == 0.0:
            return MOTORS_BRAKED
        return MotorCommands(forward_m_s - half_m_s, forward_m_s + half_m_s)

    def _next_odometry(self) -> Odometry:
        geometry = self._settings.geometry
        left_m, right_m = (ticks * geometry.metres_per_tick for ticks in (self._left_ticks, self._right_ticks))
        self._left_ticks = self._right_ticks = 0
        forward_m, turn_rad = (left_m + right_m) / 2, (right_m - left_m) / geometry.effective_track_m
        middle_rad = self._heading_rad + turn_rad / 2
        self._x_m += forward_m * math.cos(middle_rad)
        self._y_m += forward_m * math.sin(middle_rad)
        self._heading_rad += turn_rad
        elapsed_s = self._odometry_cycles * self._settings.cycle_s
        half_rad = self._heading_rad / 2
        pose = Pose(Point(self._x_m, self._y_m, 0.0), Quaternion(0.0, 0.0, math.sin(half_rad), math.cos(half_rad)))
        twist = Twist(Vector3(forward_m / elapsed_s, 0.0, 0.0), Vector3(0.0, 0.0, turn_rad / elapsed_s))
        return Odometry(
            Header(to_time(self._clock.wall_s()), "odom"),
            "base_footprint",
            PoseWithCovariance(pose, _NO_COVARIANCE),
            TwistWithCovariance(twist, _NO_COVARIANCE),
        )


class LocalLink(InstantLink):
    """Topics in memory with both ends (simbridge.link_simulation.PairedLink)."""

    def __init__(self, settings: RobotSettings) -> None:
        """Make the topics of a base. Raises hal.settings.SettingsError for another kind of robot."""
        self._settings = require_turtlebot(settings)
        self._clock = SimulatedClock()
        self.topics = LocalTopics(self._settings.ros)
        """Topics, for tests that send their own messages or break the connection."""
        self.runtime_end: RobotLink = TurtlebotLink(self._settings, self.topics.join(), "topics in memory", self._clock)

    def make_controller(self, body: Body, wheels: Wheels) -> TurtlebotElectronics:  # noqa: ARG002 - it counts itself
        """Return the electronics at the robot's end."""
        return TurtlebotElectronics(self._settings, self.topics.join(), self._clock)
