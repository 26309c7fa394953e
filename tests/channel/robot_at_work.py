"""The real service with its channel on loopback, over a robot that only notes what it is told."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import anyio

from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, GuardResult, Robot, SensorReadings, WheelSpeeds
from hal.robot_settings import load_robot
from kurt2rt.channel.security.pairing import LOCAL, Pairing, local_pairing
from kurt2rt.channel.server.channel import Channel
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import AUTO
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.runtime import Runtime
from kurt2rt.service.assembly import RunSettings
from kurt2rt.service.post_tick import ProgramConsole
from kurt2rt.service.serve import ChannelOptions, ServeOptions, serve
from kurt2rt.service.settings import ServiceSettings, load_service

SETTINGS = load_robot()
PERIOD_S = SETTINGS.cycle_s
REACH_TICKS = 35
"""A robot whose teacher is gone stands so many ticks after the last message that he sent (350 ms)."""
_LONGEST_S = 60.0


class CheapRobot:
    """Sees the same on all sensors until the test changes it, and drives as it is told (hal.robot.Robot)."""

    def __init__(self) -> None:
        self.counts = 100
        self.latched = False

    def sense(self, now_s: float) -> SensorReadings:
        """Return fresh readings."""
        count = len(SETTINGS.infrared.sensors)
        return SensorReadings(now_s, (self.counts,) * count, 0.0, 0, 0, 0.0, 0, 0.0)

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:  # noqa: ARG002
        """Grants all until it is latched."""
        return GuardResult(STANDSTILL if self.latched else wanted, (), self.latched)

    def emergency_stop(self, reason: GuardReason) -> None:  # noqa: ARG002
        self.latched = True

    def release(self) -> None:
        self.latched = False

    def close(self) -> None:
        self.latched = True


@dataclass
class RobotAtWork:
    """The running service, and all that its ticks did."""

    robot: CheapRobot
    pairing: Pairing
    other: Pairing
    """Pairing of another teacher."""
    channel: Channel
    knowledge: Path
    records: list[TickRecord] = field(default_factory=list)
    ended: bool = False
    """True after the service has ended; a signal to this process ends it too."""

    @property
    def runtime(self) -> Runtime:
        runtime: Runtime = self.channel.handler._runtime
        return runtime

    @property
    def port(self) -> int:
        port: int = self.channel.endpoint.port
        return port

    @property
    def tick(self) -> int:
        """Tick of the newest record."""
        return self.records[-1].tick if self.records else 0

    def moved_since(self, tick: int) -> list[int]:
        """Ticks after this one in which the wheels were told to turn."""
        late: list[int] = []
        for record in reversed(self.records):
            if record.tick <= tick:
                break
            if record.guard_result.wheel_speeds != STANDSTILL:
                late.append(record.tick)
        return late[::-1]

    async def until(self, holds: Callable[[], bool]) -> None:
        """Wait for something that a tick may have changed; at most a minute of the loop's time."""
        with anyio.fail_after(_LONGEST_S):
            while not holds():  # noqa: ASYNC110 - a tick sets no event
                await anyio.sleep(PERIOD_S)

    def end(self) -> None:
        self.runtime.scheduler.end()


def service_settings(folder: Path) -> ServiceSettings:
    """All files in one folder, any free port."""
    names = {"knowledge": "lessons.knowledge", "teachers": "teachers", "devices": "devices"}
    paths = {key: str(folder / name) for key, name in names.items()}
    return load_service().model_copy(update={**paths, "port": 0})


@asynccontextmanager
async def robot_at_work(folder: Path) -> AsyncIterator[RobotAtWork]:
    """Serve in the running loop until the block ends; then the journal is closed.

    Its teachers are those of this machine, so it listens on loopback only.
    """
    service = service_settings(folder)
    mine, other = (local_pairing(folder / "teachers", folder / "devices", name) for name in (LOCAL, AUTO))
    robot = CheapRobot()
    records: list[TickRecord] = []
    opened: asyncio.Future[Channel] = asyncio.get_running_loop().create_future()

    async def serve_it() -> None:
        as_robot: Robot = robot
        await serve(
            as_robot,
            RunSettings(SETTINGS, load_task("wall_following"), service),
            ProgramConsole(status=_nothing, question=_nothing, acknowledged=_nothing),
            ServeOptions(on_tick=records.append, channel=ChannelOptions(on_open=opened.set_result)),
        )
        at_work.ended = True

    async with anyio.create_task_group() as tasks:
        tasks.start_soon(serve_it)
        at_work = RobotAtWork(robot, mine, other, await opened, Path(service.knowledge), records)
        try:
            yield at_work
        finally:
            at_work.end()


def journal_of(folder: Path) -> list[TeachingEvent]:
    """Return the lessons in the journal after the end of the service."""
    with Journal.read_only(folder / "lessons.knowledge") as journal:
        return list(journal.events())


def _nothing(_: Any) -> None:
    pass
