"""A simulated robot at work, a link to it that can be cut, and the page's server behind that link, in one thread."""

from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import anyio
import anyio.from_thread
import pytest

from hal.kurt2_settings import Kurt2Settings
from hal.robot_settings import load_robot
from kurt2rt.channel.protocol.requests import PlaceRequest
from kurt2rt.channel.protocol.state import State
from kurt2rt.channel.security.pairing import Device, local_pairing
from kurt2rt.channel.server.channel import Channel
from kurt2rt.core.task_settings import load_task
from kurt2rt.service.assembly import RunSettings
from kurt2rt.service.post_tick import ProgramConsole
from kurt2rt.service.serve import ChannelOptions, ServeOptions, serve
from kurt2rt.service.shutdown import ProcessContext
from kurt2rt.service.simulated_runs import SimulatedRun, SimulatedRuns
from kurt2rt.service.systemd.notifier import Notifier
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.device_pages import DevicePages, PageSite
from kurt2rt.teacher.page.server import PagePort
from simbridge.realtime import RealtimeSimulation, RealtimeWorld
from simbridge.robot_simulation import Kurt2Simulation
from simbridge.worlds.world_loading import load_world
from tests.channel.jumping_loop import LoopClock
from tests.channel.lossy_link import LossyLink
from tests.channel.robot_at_work import service_settings
from tests.teacher.page.page_time import PageTime, stepped_portal
from tests.teacher.page.phone import Phone

_SEED = 1


@dataclass
class Classroom:
    """The page's server and the robot live in a thread, whose time passes while a test waits for its page."""

    portal: anyio.from_thread.BlockingPortal
    time: PageTime
    link: LossyLink
    client: TeacherClient
    address: str
    """Opens the page."""

    def state(self) -> State:
        """Return the newest state that came over the link."""
        state = self.portal.call(lambda: self.client.state)
        assert state is not None
        return state

    def put_robot_in_the_open(self) -> None:
        """Place the robot where no wall makes the guard stop it."""
        answer = self.time.pass_until(lambda: self.client.send(PlaceRequest, x_m=2.2, y_m=2.0, heading_rad=0.0))
        assert answer.accepted, answer.text

    def cut(self) -> None:
        """Nothing comes through to the robot any more, nor back."""
        self.portal.call(self.link.cut)

    def mend(self) -> None:
        """Restore the link."""
        self.portal.call(self.link.mend)


@contextmanager
def classroom(folder: Path, phone: Phone, task: str = "wall_following") -> Iterator[Classroom]:
    """Open everything, in this order, and close it again."""
    with (
        stepped_portal() as (portal, time),
        portal.wrap_async_context_manager(_robot(folder, task)) as (port, device),
        portal.wrap_async_context_manager(LossyLink(port)) as link,
        portal.wrap_async_context_manager(_client(device, link.port)) as client,
        _served(portal, client, device) as address,
        time.shown_on(phone),
    ):
        yield Classroom(portal, time, link, client, address)


@asynccontextmanager
async def _client(device: Device, port: int) -> AsyncIterator[TeacherClient]:
    async with TeacherClient(device.folder, "127.0.0.1", port, now=anyio.current_time) as client:
        yield client


class _SteppedClock(LoopClock):
    """Clock of the runtime whose world takes a step before each tick."""

    def __init__(self, world: RealtimeSimulation) -> None:
        self._world = world

    async def wait_until(self, deadline_s: float) -> None:
        await super().wait_until(deadline_s)
        self._world.step()


@asynccontextmanager
async def _robot(folder: Path, name: str) -> AsyncIterator[tuple[int, Device]]:
    """Serve the simulated robot as `kurt2rt run` does, without threads; return its port and its teacher."""
    settings, task = load_robot(), load_task(name)
    assert isinstance(settings, Kurt2Settings)
    world = load_world(task.teaching.world, settings)
    service = service_settings(folder).model_copy(update={"task": name, "world": task.teaching.world})
    device = local_pairing(Path(service.teachers), Path(service.devices)).device
    opened: list[Channel] = []
    is_open, ended = anyio.Event(), anyio.Event()

    def on_open(channel: Channel) -> None:
        opened.append(channel)
        is_open.set()

    simulation = Kurt2Simulation(settings, task.teaching.world, _SEED, "run", loaded=world)
    held = RealtimeSimulation(simulation.simulated_robot)
    runs = SimulatedRuns(
        settings,
        SimulatedRun(task.teaching.world, task, name, Path(service.knowledge)),
        cast(Any, None),
        taught_by_script=False,
    )
    options = ChannelOptions(
        simulated_world=RealtimeWorld(simulation.simulated_robot, world, settings.geometry, held),
        on_open=on_open,
        run_control=runs,
    )
    nothing = lambda _: None  # noqa: E731
    console = ProgramConsole(status=nothing, question=nothing, acknowledged=nothing)

    async def work() -> None:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("kurt2rt.service.serve.TimerfdClock", lambda: _SteppedClock(held))
            context = ProcessContext(cast(Any, _NoSignals()), Notifier({}))
            serving = ServeOptions(channel=options, context=context)
            await serve(simulation.robot, RunSettings(settings, task, service), console, serving)
        ended.set()

    async with anyio.create_task_group() as tasks:
        tasks.start_soon(work)
        await is_open.wait()
        try:
            yield opened[0].endpoint.port, device
        finally:
            opened[0].handler._runtime.scheduler.end()
            await ended.wait()
            simulation.close()


@dataclass
class _NoSignals:
    """Shutdown of a program that gets no signal, outside the main thread."""

    stage: object = None
    requested: bool = False

    def remaining_s(self, wanted_s: float) -> float:
        return wanted_s

    def on_shutdown(self, *_: object) -> "nullcontext[None]":
        return nullcontext()


@contextmanager
def _served(portal: anyio.from_thread.BlockingPortal, client: TeacherClient, device: Device) -> Iterator[str]:
    with portal.wrap_async_context_manager(_pages(client, device)) as port:
        yield f"http://127.0.0.1:{port}/pair?token={device.token}"


@asynccontextmanager
async def _pages(client: TeacherClient, device: Device) -> AsyncIterator[int]:
    async with anyio.create_task_group() as tasks:
        pages = DevicePages(tasks, PageSite(lambda _: nullcontext(client), "127.0.0.1", [], "127.0.0.1"))
        pages.serve([device])
        await pages.open_links()
        port = PagePort(pages, tasks, 0)
        await port.open(everywhere=False)
        yield port.port
        await pages.end()
        port.end()
