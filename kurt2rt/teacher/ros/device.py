"""Device that joins a robot to ROS 2: it publishes what the robot tells, and passes on what nodes ask for."""

import math
import time
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

import anyio

from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.ros import messages as ros
from kurt2rt.ros.message_age import StampedAge
from kurt2rt.ros.topic import topic_of
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.ros.feed import Feed
from kurt2rt.teacher.ros.robot_messages import status
from kurt2rt.teacher.ros.services import RosServer, Services
from kurt2rt.teacher.ros.twist_drive import LEASE_S, DriveLimits, TwistDrive

_POLL_S = 0.02
_RETRY_S = 0.5

Say = Callable[[str], None]


class _Arrived(NamedTuple):
    """Newest message of a topic, set in a thread of the connection and taken by the loop."""

    payload: bytes
    at_s: float


class RosDevice:
    """The robot in ROS 2, for as long as the client of a paired device is open."""

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
