"""Bus, disk, network and teacher come in any order: until all are there, and the teacher said Go, the robot stands."""

import io
import queue
import signal
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from itertools import permutations
from pathlib import Path

import anyio
import pytest
from rich.console import Console

from hal.bus import BusError
from hal.control import SystemControl, decode_control, encode_brake
from hal.robot import STANDSTILL
from hal.robot_settings import RobotSettings
from hal.tap import Tap
from kurt2rt.channel.security.pairing import LOCAL, local_pairing
from kurt2rt.cli.terminal_screen import TerminalScreen
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.commands import Command, Resume, Take, Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.service.health.status_error import StatusCode, StatusError
from kurt2rt.service.health.status_socket import read_reports, status_socket_path
from kurt2rt.service.open_robot import OpenedRobot
from kurt2rt.service.program import RobotProgram
from kurt2rt.service.run_options import ProgramEnvironment, RunOptions
from kurt2rt.service.settings import load_service
from kurt2rt.teacher import TeacherClient
from tests.service.rig import SETTINGS, Rig, end_service, rig
from tests.service.systemd.manager import manager

TASK = load_task("wall_following")
BRAKE = bytes(encode_brake().data)
ALL = ("bus", "disk", "network", "teacher")
IN_TURN = [ALL, ALL[1:] + ALL[:1]]
"""The teacher comes last, and the bus."""
ORDERS = RunOptions(bus="can0", as_service=True, stopped=True, record=False)


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Knowledge by which the robot would drive at once."""
    path = tmp_path_factory.mktemp("taught") / "lessons.knowledge"

    def watch(record: TickRecord) -> Command | None:
        if record.decision.driving:
            end_service()
        return Teach(f"lesson-{record.tick}", "Ann", "forward") if record.decision.asking else None

    with rig() as here:
        anyio.run(lambda: here.serve(path, watch, task=TASK))
    return path.read_bytes()


class Log(io.StringIO):
    """Printed lines of the program."""

    def __init__(self) -> None:
        super().__init__()
        self._lines: queue.SimpleQueue[str] = queue.SimpleQueue()

    def write(self, text: str) -> int:
        for line in text.splitlines():
            self._lines.put(line)
        return len(text)

    def wait_for(self, *texts: str) -> None:
        """Read until each text has been in a line, in any order."""
        waiting = set(texts)
        while waiting:
            line = self._lines.get(timeout=60)
            waiting = {text for text in waiting if text not in line}


class World:
    """Machine on which the program is started; each dependency is missing until the test adds it."""

    def __init__(self, folder: Path, here: Rig, taught: bytes, around: ExitStack) -> None:
        self.log = Log()
        self._here = here
        self._bus_is_there = threading.Event()
        self._elsewhere, self._disk = folder / "elsewhere", folder / "disk"
        self._elsewhere.mkdir()
        (self._elsewhere / "lessons.knowledge").write_bytes(taught)
        self._taken = around.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        self._taken.bind(("127.0.0.1", 0))
        self._port: int = self._taken.getsockname()[1]
        self._device = local_pairing(folder / "teachers", folder / "devices", LOCAL).device.folder
        self._drives = threading.Event()
        self._teacher = threading.Thread(target=anyio.run, args=(self._teach,))
        self._around = around
        self.service = load_service().model_copy(
            update={
                "knowledge": str(self._disk / "lessons.knowledge"),
                "teachers": str(folder / "teachers"),
                "devices": str(folder / "devices"),
                "port": self._port,
            }
        )

    @contextmanager
    def open_robot(
        self, settings: RobotSettings, bus: str, world: str, seed: int, tap: Tap | None = None
    ) -> Iterator[OpenedRobot]:
        del settings, world, seed, tap
        if not self._bus_is_there.is_set():
            raise BusError(f"bus {bus!r}: no such network interface")
        yield OpenedRobot(self._here.robot, None, lambda: self._here.simulation.error is None)

    def comes(self, what: str) -> None:
        """Add the dependency, and wait until it is noticed unless another one is needed first."""
        match what:
            case "bus":
                self._bus_is_there.set()
                self.log.wait_for("bus is there")
            case "disk":
                self._elsewhere.rename(self._disk)
                self.log.wait_for("knowledge is there")
            case "network":
                self._taken.close()
                self.log.wait_for("network is there")
            case "teacher":
                self._teacher.start()

    def drives(self) -> None:
        """Wait until the wheels turn."""
        assert self._drives.wait(60)
        self._teacher.join()

    async def _teach(self) -> None:
        async with TeacherClient(self._device, port=self._port, patience_s=60) as robot:
            assert (await robot.send(Take)).accepted
            assert robot.state is None or robot.state.cause == "stopped"
            async for state in robot.states():
                if (state.left_m_s, state.right_m_s) != STANDSTILL:
                    self._drives.set()
                    return
                if state.stopped or state.guard:  # the guard stops it on a machine that is too slow as well
                    await robot.send(Resume)


def turns_wheels(payload: bytes) -> bool:
    control = decode_control(payload)
    assert not isinstance(control, SystemControl)
    return control.wheel_speeds(SETTINGS.motors) != STANDSTILL


def play(program: RobotProgram, story: Callable[[], None]) -> None:
    """Run the program here, where signals arrive, and the story in a thread; the story's end ends the program."""
    failures: list[BaseException] = []

    def tell() -> None:
        try:
            story()
        except BaseException as error:  # noqa: BLE001  # raised where the test sees it
            failures.append(error)
        finally:
            end_service(signal.SIGTERM)

    story_thread = threading.Thread(target=tell)
    story_thread.start()
    program.run()
    story_thread.join()
    if failures:
        raise failures[0]


@pytest.mark.parametrize(
    "order",
    [
        pytest.param(order, marks=() if order in IN_TURN else pytest.mark.deep, id=" ".join(order))
        for order in permutations(ALL)
    ],
)
def test_start_in_any_order_stands_until_resume(
    order: tuple[str, ...], tmp_path: Path, taught: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    with ExitStack() as around:
        systemd = around.enter_context(manager(tmp_path))
        for name, value in systemd.environment(0.2).items():
            monkeypatch.setenv(name, value)
        here = around.enter_context(rig())
        world = World(tmp_path, here, taught, around)
        program = program_in(world)

        def story() -> None:
            world.log.wait_for("waits for bus", "waits for knowledge", "waits for network")
            for what in order[:-1]:
                world.comes(what)
            if order[-1] == "teacher":
                world.log.wait_for("stands until Go: the robot program was started")
            assert not any(map(turns_wheels, here.control_payloads()))
            told = systemd.heard()
            assert "WATCHDOG=1" in told
            assert told[0] == "READY=1"
            world.comes(order[-1])
            world.drives()
            assert any(map(turns_wheels, here.control_payloads()))

        play(program, story)
        assert here.control_payloads()[-1] == BRAKE


def test_its_status_says_what_it_waits_for(tmp_path: Path, taught: bytes) -> None:
    with ExitStack() as around:
        world = World(tmp_path, around.enter_context(rig()), taught, around)
        program = program_in(world)
        knowledge = Path(world.service.knowledge)

        def story() -> None:
            world.log.wait_for("waits for bus", "waits for knowledge", "waits for network")
            assert status_of(knowledge).code is StatusCode.NO_PROGRAM
            world.comes("disk")
            while (told := status_of(knowledge)).code is StatusCode.NO_PROGRAM:  # it is told a moment later
                pass
            assert told.code is StatusCode.WAITS
            assert "bus: bus 'can0'" in told.what
            assert "network: " in told.what

        play(program, story)


def program_in(world: World) -> RobotProgram:
    return RobotProgram(
        ORDERS,
        world.service,
        SETTINGS,
        TASK,
        TerminalScreen(Console(file=world.log), Path(), as_service=True),
        ProgramEnvironment(world.open_robot, on_timeout=None, retry_s=0.01),
    )


def status_of(knowledge: Path) -> StatusError:
    """Why another program gets no report."""
    with pytest.raises(StatusError) as told:
        next(read_reports(status_socket_path(knowledge), 60.0))
    return told.value
