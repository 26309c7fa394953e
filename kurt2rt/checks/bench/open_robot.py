"""Robot that is open to teachers over the network, assembled like the service."""

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, closing
from dataclasses import dataclass
from pathlib import Path

import anyio
import anyio.to_thread

from kurt2rt.channel.security.pairing import Device, local_pairing
from kurt2rt.channel.server.channel import Channel
from kurt2rt.checks.bench.lateness_clock import LatenessClock
from kurt2rt.checks.bench.press_schedule import ObservedRobot
from kurt2rt.checks.bench.robot_under_test import BenchFixture, open_writer
from kurt2rt.checks.bench.tick_phase import LoopPacer
from kurt2rt.core.decision.active_stop import STARTED
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.writer import JournalWriter
from kurt2rt.platform.gc_control import gc_frozen
from kurt2rt.platform.timerfd_clock import TimerfdClock
from kurt2rt.runtime import Runtime, RuntimeOptions, build_runtime
from kurt2rt.service.assembly import RobotService, open_service_channel
from kurt2rt.service.post_tick import PostTick, ProgramConsole
from kurt2rt.service.settings import load_service

_PATIENCE_S = 30.0


class PauseGate:
    """Callback after each tick: the service's part, and a check of an awaited condition."""

    def __init__(self, with_channel: PostTick, without: PostTick) -> None:
        self.open = True
        """True if the channel takes part."""
        self.ticks = 0
        self.driving = 0
        """Ticks in which an action drove the wheels."""
        self.newest: TickRecord | None = None
        self._with_channel = with_channel
        self._without = without
        self._condition: Callable[[], bool] | None = None
        self._noticed = anyio.Event()

    def __call__(self, record: TickRecord) -> None:
        """Run the service's part after one tick."""
        self.ticks += 1
        self.driving += record.decision.driving
        self.newest = record
        (self._with_channel if self.open else self._without)(record)
        if self._condition is not None and self._condition():
            self._condition = None
            self._noticed.set()

    async def until(self, condition: Callable[[], bool]) -> None:
        """Wait until a condition holds after a tick; one waiter at a time. Raises TimeoutError after 30 s."""
        self._noticed = anyio.Event()
        self._condition = condition
        with anyio.fail_after(_PATIENCE_S):
            await self._noticed.wait()

    async def run_ticks(self, ticks: int) -> None:
        """Wait until the robot has run this number of ticks. Raises TimeoutError after 30 s."""
        last = self.ticks + ticks
        await self.until(lambda: self.ticks >= last)


@dataclass(frozen=True, slots=True)
class OpenRobot:
    """Robot that ticks by itself inside `open_robot`."""

    runtime: Runtime
    writer: JournalWriter
    channel: Channel
    observer: ObservedRobot
    clock: LatenessClock
    device: Device
    """Paired device of a teacher."""
    gate: PauseGate
    pace: LoopPacer

    @property
    def address(self) -> tuple[str, ...]:
        """Arguments for a helper process: folder of the pairing, and UDP port."""
        return str(self.device.folder), str(self.channel.endpoint.port)


@asynccontextmanager
async def open_robot(fixture: BenchFixture, folder: Path) -> AsyncIterator[OpenRobot]:
    """Start a robot that stands and is open to teachers; knowledge and pairing go to a new `folder`.

    Raises KnowledgeError, ChannelError, CredentialsError, OSError without a timerfd, and errors of the block unwrapped.
    """
    pairing = local_pairing(folder / "teachers", folder / "devices")
    service = load_service().model_copy(
        update={"knowledge": str(folder / "bench.knowledge"), "teachers": str(folder / "teachers"), "port": 0}
    )
    failed: Exception | None = None
    with (
        closing(fixture.open_simulation(f"bench {folder.name}")) as simulation,
        open_writer(fixture, Path(service.knowledge)) as writer,
        TimerfdClock() as real_clock,
        simulation.live(),
        gc_frozen(),
    ):
        clock = LatenessClock(real_clock)
        observer = ObservedRobot(simulation.robot, clock)
        runtime = build_runtime(
            observer, fixture.settings, fixture.task, fixture.events, writer, clock, RuntimeOptions(attended=True)
        )
        runtime.handler.stop(STARTED)
        robot = RobotService(runtime, writer, service)
        console = ProgramConsole(status=lambda _: None, question=lambda _: None, acknowledged=lambda _: None)
        async with (
            anyio.create_task_group() as tasks,
            open_service_channel(robot, robot.channel_dependencies()) as channel,
        ):
            gate = PauseGate(PostTick(robot, console, channel=channel), PostTick(robot, console))
            pace = LoopPacer(runtime.scheduler, clock)
            tasks.start_soon(pace.run, gate)
            try:
                yield OpenRobot(
                    runtime=runtime,
                    writer=writer,
                    channel=channel,
                    observer=observer,
                    clock=clock,
                    device=pairing.device,
                    gate=gate,
                    pace=pace,
                )
            except Exception as error:  # noqa: BLE001  # raised below: a task group would wrap it
                failed = error
            pace.end()
    if failed is not None:
        raise failed
