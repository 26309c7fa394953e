"""Device that joins a robot to ROS 2: it publishes what the robot tells, and passes on what nodes ask for."""

import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import NamedTuple

import anyio

from kurt2rt.channel.protocol.health import Trouble
from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.decision import ASKING
from kurt2rt.ros import messages as ros
from kurt2rt.ros.inbox import StampedAge
from kurt2rt.ros.port import RosPort
from kurt2rt.ros.topic import topic_of
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.client.observer_client import ObserverClient
from kurt2rt.teacher.ros.robot_messages import (
    Odometer,
    ScanBuilder,
    link_status,
    odometry,
    robot_status,
    status,
    transform,
    trouble_status,
)
from kurt2rt.teacher.ros.services import RosServer, Services
from kurt2rt.teacher.ros.twist_drive import LEASE_S, DriveLimits, TwistDrive
from kurt2rt.teacher.terminal.terminal_text import build_question

_POLL_S = 0.02
_RETRY_S = 0.5

Say = Callable[[str], None]


_DIAGNOSE_S = 1.0


class Feed:
    """Publisher of a robot's states on ROS 2: scan, pose, question and diagnostics."""

    def __init__(self, robot: ObserverClient, port: RosPort, hello: Hello, wall: Callable[[], float]) -> None:
        """Declare the topics. `wall`: clock of ROS in s since 1970. Raises RosConnectionError."""
        self._robot, self._wall = robot, wall
        self._scan = port.publisher(topic_of("scan", ros.LaserScan))
        self._odometry = port.publisher(topic_of("odom", ros.Odometry))
        self._transform = port.publisher(topic_of("/tf", ros.TFMessage))
        self._question = port.publisher(topic_of("question", ros.String))
        self._diagnostics = port.publisher(topic_of("/diagnostics", ros.DiagnosticArray))
        self._asks: tuple[str, str] | None = None
        """Reason and behaviour of the question; None without one."""
        self._asked = ""
        self._odometer = Odometer()
        self.introduce(hello)

    def introduce(self, hello: Hello) -> None:
        """Describe the robot of the states from now on; its pose goes on where it was."""
        self._hello = hello
        self._scans = ScanBuilder(hello)

    def on_state(self, state: State) -> None:
        """Publish a state. Raises RosConnectionError if the connection is closed."""
        now_s, hello = self._wall(), self._hello
        if math.isfinite(state.infrared_age_s):
            self._scan.publish(self._scans.build(state.infrared_counts, ros.to_time(now_s - state.infrared_age_s)))
        place = self._odometer.update(state, hello.track_m, hello.period_s)
        stamp = ros.to_time(now_s)
        self._odometry.publish(odometry(place, stamp))
        self._transform.publish(transform(place.pose, stamp))
        asks = (state.standing.reason, state.behaviour) if state.standing.asks else None
        # One question has one text. States of moments in which noise lets the robot drive do not have its words.
        if asks != self._asks and (asks is None or state.cause in ASKING):
            self._asks = asks
            self._asked = "" if asks is None else str(build_question(state, hello.sensor_words))
            self._question.publish(ros.String(self._asked))

    async def diagnose(self, more: Callable[[], Sequence[ros.DiagnosticStatus]]) -> None:
        """Publish the diagnostics once a second, with `more`, and repeat the question for late listeners.

        Raises RosConnectionError if the connection is closed.
        """
        while True:
            robot, hello = self._robot, self._hello
            found = [link_status(robot.link, robot.trouble, robot.state_age_s, hello.robot), *more()]
            if robot.state is not None:
                found.append(robot_status(robot.state, hello))
            found += [trouble_status(each, hello.robot) for each in await self._troubles()]
            self._diagnostics.publish(ros.DiagnosticArray(ros.Header(ros.to_time(self._wall()), ""), found))
            self._question.publish(ros.String(self._asked))
            await anyio.sleep(_DIAGNOSE_S)

    async def _troubles(self) -> tuple[Trouble, ...]:
        try:
            report = await self._robot.health()
        except NoAnswerError:  # the status of the link tells it
            return ()
        return () if report is None else report.troubles


class _Arrived(NamedTuple):
    """Newest message of a topic, set in a thread of the connection and taken by the loop."""

    payload: bytes
    at_s: float


class RosDevice:
    """Device that joins one robot to ROS 2, for as long as the client of its pairing is open."""

    def __init__(
        self,
        robot: TeacherClient,
        port: RosServer,
        say: Say,
        *,
        stamped: bool = False,
        now: Callable[[], float] = time.monotonic,
        wall: Callable[[], float] = time.time,
    ) -> None:
        """Name both sides; nothing is sent before `run`.

        Args:
            robot: open client of the paired device.
            port: connection to ROS 2.
            say: receiver of lines for the user.
            stamped: whether cmd_vel carries TwistStamped; else it carries Twist.
            now: monotonic clock in s.
            wall: clock of ROS in s since 1970.
        """
        self._robot, self._port, self._say = robot, port, say
        self._stamped, self._now, self._wall = stamped, now, wall
        self._twist: _Arrived | None = None
        self._watched_s = -math.inf
        self._ages = StampedAge(now(), wall())

    async def run(self) -> None:
        """Serve until cancelled; the robot need not be there yet, and may restart.

        Raises RosConnectionError if the connection is closed.
        """
        robot = self._robot
        robot.watching = False  # the robot is told of a teacher only while a node says that it watches
        hello = await self._meet()
        async with anyio.create_task_group() as tasks:

            def let_go() -> None:
                tasks.start_soon(self._let_go)

            limits = _limits(hello)
            drive = TwistDrive(robot, limits, now=self._now, let_go=let_go)
            services = Services(robot, self._port, tasks)
            feed = Feed(robot, self._port, hello, self._wall)
            self._introduce(hello, services)
            self._port.subscribe(topic_of("cmd_vel", ros.TwistStamped if self._stamped else ros.Twist), self._on_twist)
            self._port.subscribe(topic_of("watch", ros.String), self._on_watch)
            tasks.start_soon(services.work)
            tasks.start_soon(self._poll, drive)
            tasks.start_soon(feed.diagnose, lambda: [self._drive_status(drive, hello.robot)])
            async for state in robot.states():
                if state.boot != hello.boot:
                    hello = await self._meet()
                    feed.introduce(hello)
                    drive.limits = _limits(hello)
                    self._introduce(hello, services)
                else:
                    feed.on_state(state)

    async def _meet(self) -> Hello:
        """Return the robot's introduction, as soon as it is there."""
        told = ""
        while True:
            try:
                return await self._robot.hello()
            except NoAnswerError:
                line = f"no robot answers yet{f': {self._robot.trouble}' if self._robot.trouble else ''}"
                if line != told:
                    self._say(line)
                told = line
                await anyio.sleep(_RETRY_S)

    def _introduce(self, hello: Hello, services: Services) -> None:
        unnamed = services.offer(hello)
        self._say(f"{hello.robot}, task {hello.task}, is in ROS 2")
        if unnamed:
            self._say(f"no service for {', '.join(unnamed)}: ROS allows letters, digits and _ in names")

    def _on_twist(self, payload: bytes) -> None:
        self._twist = _Arrived(payload, self._now())

    def _on_watch(self, _: bytes) -> None:
        self._watched_s = self._now()

    async def _poll(self, drive: TwistDrive) -> None:
        """Apply the newest twist and the leases of twists and of the watching node."""
        while True:
            self._robot.watching = self._now() - self._watched_s < LEASE_S
            arrived, self._twist = self._twist, None
            if arrived is not None:
                self._apply(arrived, drive)
            drive.poll()
            await anyio.sleep(_POLL_S)

    def _apply(self, arrived: _Arrived, drive: TwistDrive) -> None:
        try:
            if not self._stamped:
                drive.on_twist(ros.decode(arrived.payload, ros.Twist), arrived.at_s)
                return
            message = ros.decode(arrived.payload, ros.TwistStamped)
            age_s = self._ages.on_arrival(message, arrived.at_s)
            if age_s is None:
                drive.refuse("the twist's stamp does not go on from the one before; was a clock set?", arrived.at_s)
            elif age_s < LEASE_S:
                drive.on_twist(message.twist, arrived.at_s - age_s)
            else:
                drive.refuse(f"the twist is {age_s:.2f} s old, allowed is {LEASE_S:g}", arrived.at_s)
        except ros.InvalidMessageError as error:
            drive.refuse(f"not a twist: {error}", arrived.at_s)

    def _drive_status(self, drive: TwistDrive, robot: str) -> ros.DiagnosticStatus:
        level = ros.DiagnosticStatus.WARN if drive.trouble else ros.DiagnosticStatus.OK
        message = drive.trouble or ("drives" if drive.on else "no twist drives")
        return status(level, f"{robot}: cmd_vel", message, robot, refused=drive.refused, watched=self._robot.watching)

    async def _let_go(self) -> None:
        with suppress(NoAnswerError):  # the robot ends the press by itself
            await self._robot.let_go()


def _limits(hello: Hello) -> DriveLimits:
    return DriveLimits(hello.track_m, hello.max_m_s)
