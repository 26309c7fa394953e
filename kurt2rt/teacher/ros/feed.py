"""Topics that tell ROS 2 about the robot: scan, odometry and transform with each state, diagnostics each second."""

import math
from collections.abc import Callable, Sequence

import anyio

from kurt2rt.channel.protocol.health import Trouble
from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.decision import ASKING
from kurt2rt.ros import messages as ros
from kurt2rt.ros.port import RosPort
from kurt2rt.ros.topic import topic_of
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.client.observer_client import ObserverClient
from kurt2rt.teacher.ros.odometer import Odometer
from kurt2rt.teacher.ros.robot_messages import (
    ScanBuilder,
    link_status,
    odometry,
    robot_status,
    transform,
    trouble_status,
)
from kurt2rt.teacher.terminal.terminal_text import build_question

_DIAGNOSE_S = 1.0


class Feed:
    """Publisher of one robot's topics."""

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
