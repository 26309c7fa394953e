"""Simulated base: its electronics at the other end of the topics, in memory or over zenoh."""

from collections.abc import Sequence

from hal.odometry import PlanePose, WheelOdometry
from hal.robot_link import RobotLink
from hal.robot_settings import RobotSettings
from kurt2rt.robots.turtlebot.lidar import ScanReadings
from kurt2rt.robots.turtlebot.link import TurtlebotLink
from kurt2rt.robots.turtlebot.settings import TurtlebotSettings, require_turtlebot
from kurt2rt.ros.inbox import Clock, Inbox
from kurt2rt.ros.laser_scan import full_turn_scan
from kurt2rt.ros.messages import LaserScan, Odometry
from kurt2rt.ros.odometry import odometry_message
from kurt2rt.ros.port import LocalTopics, RosPort
from kurt2rt.ros.topic import topic_of
from kurt2rt.ros.twist import PlaneTwist, Twists
from simbridge.controller.controller import MOTORS_BRAKED, MotorCommands
from simbridge.links import InstantLink
from simbridge.robot.body import Body
from simbridge.robot.wheels import Wheels


class SimulatedClock:
    """Clock that the electronics advances (kurt2rt.ros.inbox.Clock); a robot in memory stamps by it too."""

    def __init__(self) -> None:
        self.time_s = 1.0
        """Simulated time; a stamp of 0 would mean none."""

    def now_s(self) -> float:
        """Return the simulated time in s."""
        return self.time_s

    wall_s = now_s


class TurtlebotElectronics:
    """Electronics of a base (simbridge.controller.controller.Controller): it obeys /cmd_vel and sends /odom and /scan.

    It stops without /cmd_vel for the time of its watchdog, which a real TurtleBot3 does not (docs/other-robots.md).
    """

    crashed = False

    def __init__(self, settings: TurtlebotSettings, port: RosPort, clock: Clock) -> None:
        """Use `port`, and stamp by `clock`. Raises kurt2rt.ros.port.RosConnectionError."""
        topics, self._settings, self._clock = settings.ros, settings, clock
        self._twists, self._odometry = Twists(settings.twist, settings), WheelOdometry(settings.geometry)
        kind = self._twists.message_class
        self._inbox = Inbox(port, topic_of(topics.cmd_vel, kind), kind, clock)
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
        self._pose = PlanePose()

    @property
    def junk_frames(self) -> int:
        """Number of twists that could not be read."""
        return self._inbox.junk

    @property
    def watchdog_expired(self) -> bool:
        """Return whether no valid /cmd_vel has arrived for the watchdog's time."""
        return self._silent_cycles >= self._watchdog_cycles

    @property
    def state(self) -> tuple[int, ...]:
        """Inputs of the next cycle besides the present commands, for the state hash."""
        return self._silent_cycles, self._cycles, self._left_ticks, self._right_ticks

    def receive(self) -> None:
        """Run the first half of a cycle: obey the twists that arrived."""
        self._silent_cycles += 1
        for twist in self._inbox.take(lambda message, _: self._twists.obeyed(message)):
            stands = twist == PlaneTwist(0.0, 0.0)
            self.commands = MOTORS_BRAKED if stands else MotorCommands(*self._twists.to_wheels(twist))
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
        stamp_s, lidar = self._clock.wall_s(), self._settings.lidar
        if self._fresh is not None:
            limits_m = (lidar.nearest_m, lidar.farthest_m)
            self._scan.publish(full_turn_scan(self._fresh.ranges_m, limits_m, lidar.period_s, stamp_s))
            self._fresh = None
        if self._cycles % self._odometry_cycles == 0:
            motion = self._odometry.motion(self._left_ticks, self._right_ticks)
            self._left_ticks = self._right_ticks = 0
            self._pose = self._pose.moved(motion.forward_m, motion.turn_rad)
            period_s = self._settings.odometry_period_s
            speeds = (motion.forward_m / period_s, motion.turn_rad / period_s)
            self._odom.publish(odometry_message(self._pose, *speeds, stamp_s))


class LocalLink(InstantLink):
    """Topics in memory between the runtime's driver and a simulated base.

    It is a simbridge.simulation.PairedLink.
    """

    def __init__(self, settings: RobotSettings) -> None:
        """Make the topics of a base. Raises config.settings.SettingsError for another kind of robot."""
        self._settings = require_turtlebot(settings)
        self._clock = SimulatedClock()
        self.topics = LocalTopics(self._settings.ros)
        """Topics, for tests that send their own messages or break the connection."""
        self.runtime_end: RobotLink = TurtlebotLink(self._settings, self.topics.join(), "topics in memory", self._clock)

    def make_controller(self, body: Body, wheels: Wheels) -> TurtlebotElectronics:  # noqa: ARG002 - it counts itself
        """Return the electronics at the robot's end."""
        return TurtlebotElectronics(self._settings, self.topics.join(), self._clock)
