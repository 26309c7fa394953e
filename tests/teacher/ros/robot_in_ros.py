"""The robot's real service on loopback, in simulated time, and a ROS device between it and topics in memory."""

import asyncio
from collections import defaultdict
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path

import anyio

from kurt2rt.ros import messages as ros
from kurt2rt.ros.messages import MessageT
from kurt2rt.ros.port import LocalPort, LocalTopics
from kurt2rt.ros.settings import RosSettings
from kurt2rt.ros.topic import Topic, topic_of
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.ros.device import RosDevice
from kurt2rt.teacher.ros.services import Request
from tests.channel.robot_at_work import RobotAtWork, robot_at_work

EPOCH_S = 1_790_000_000.0
"""Wall clock of ROS at the beginning of a story."""


class _Call:
    """Request of a node that waits (kurt2rt.teacher.ros.services.Request)."""

    def __init__(self) -> None:
        self.answer: asyncio.Future[tuple[bool, str]] = asyncio.get_running_loop().create_future()

    def respond(self, success: bool, text: str) -> None:
        self.answer.set_result((success, text))


class ServingPort(LocalPort):
    """End of local topics that offers services, too."""

    def __init__(self, topics: LocalTopics) -> None:
        super().__init__(topics)
        self.services: dict[str, Callable[[Request], None]] = {}

    def serve(self, service: Topic, on_request: Callable[[Request], None]) -> None:
        self.services[service.name] = on_request

    def begin(self, name: str) -> "asyncio.Future[tuple[bool, str]]":
        """Call a service; returns its answer that is to come."""
        call = _Call()
        self.services[name](call)
        return call.answer


@dataclass
class RobotInRos:
    """A robot, its device, and a node at the other end of the topics."""

    at_work: RobotAtWork
    client: TeacherClient
    topics: LocalTopics
    services: ServingPort
    lines: list[str]
    received: dict[str, list[bytes]] = field(default_factory=lambda: defaultdict(list))

    def messages(self, topic: str, kind: type[MessageT]) -> list[MessageT]:
        """Return what came on a topic so far."""
        return [ros.decode(each, kind) for each in self.received[topic]]

    async def call(self, name: str) -> tuple[bool, str]:
        return await self.services.begin(name)

    async def send(self, topic: str, message: ros.Message, seconds: float, *, every_s: float = 0.05) -> None:
        """Publish a message again and again for some time."""
        publisher = self.topics.join().publisher(topic_of(topic, type(message)))
        for _ in range(round(seconds / every_s)):
            publisher.publish(message)
            await anyio.sleep(every_s)

    async def drive(self, forward_m_s: float, turn_rad_s: float, seconds: float) -> None:
        await self.send("cmd_vel", twist(forward_m_s, turn_rad_s), seconds)

    def moved_after(self, tick: int) -> int:
        """Return the number of ticks after this one until the last that told the wheels to turn; 0 if none did."""
        return max((each - tick for each in self.at_work.moved_since(tick)), default=0)

    async def statuses(self) -> dict[str, tuple[int, str]]:
        """Return level and message of each status of the next diagnostics."""
        known = len(self.received["/diagnostics"])
        await self.at_work.until(lambda: len(self.received["/diagnostics"]) > known)
        newest = self.messages("/diagnostics", ros.DiagnosticArray)[-1]
        return {each.name.partition(": ")[2]: (each.level, each.message) for each in newest.status}


def twist(forward_m_s: float, turn_rad_s: float = 0.0) -> ros.Twist:
    return ros.Twist(ros.Vector3(forward_m_s, 0.0, 0.0), ros.Vector3(0.0, 0.0, turn_rad_s))


@asynccontextmanager
async def robot_in_ros(folder: Path, *, stamped: bool = False) -> AsyncIterator[RobotInRos]:
    """Yield a robot whose device has met it; at the end the device ends first. Call it in tests.channel.run_jumping."""
    now = asyncio.get_running_loop().time
    topics = LocalTopics(RosSettings())
    port, lines = ServingPort(topics), list[str]()
    async with robot_at_work(folder) as at_work:
        device_folder = at_work.pairing.device.folder
        async with (
            TeacherClient(device_folder, port=at_work.port, now=now) as client,
            anyio.create_task_group() as tasks,
        ):
            desk = RobotInRos(at_work, client, topics, port, lines)
            for name, kind in {
                "scan": ros.LaserScan,
                "odom": ros.Odometry,
                "/tf": ros.TFMessage,
                "/diagnostics": ros.DiagnosticArray,
            }.items():
                topics.join().subscribe(topic_of(name, kind), desk.received[name].append)
            device = RosDevice(client, port, lines.append, stamped=stamped, now=now, wall=lambda: EPOCH_S + now())
            tasks.start_soon(device.run)
            await at_work.until(lambda: bool(desk.received["/diagnostics"]))
            yield desk
            tasks.cancel_scope.cancel()
