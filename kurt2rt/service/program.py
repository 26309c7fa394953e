"""The robot program: robot, CAN log and companion programs around the service."""

import asyncio
import gc
import math
import signal
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Protocol

import anyio

from hal.guard_reason import GuardReason
from hal.health import Health
from hal.robot_settings import RobotSettings
from kurt2rt.channel.security.pairing import OF_THIS_MACHINE, local_pairing, pairing_names
from kurt2rt.channel.server.channel import EVERYWHERE, LOOPBACK, Channel
from kurt2rt.channel.server.udp_port import require_port
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.question import MidQuestion, Question
from kurt2rt.knowledge.journal.loading import OpenedKnowledge, open_for_teaching
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.malloc import pin_mmap_threshold
from kurt2rt.platform.realtime_priority import take_real_time_priority
from kurt2rt.runs.recording.can_log import CanLog, open_can_log
from kurt2rt.runs.recording.recording import Recording
from kurt2rt.runs.recording.run_files import budget_of
from kurt2rt.service.bus_names import SHARED
from kurt2rt.service.child_processes import ChildProcesses
from kurt2rt.service.config_reload import ConfigReloader
from kurt2rt.service.console_thread import ConsoleThread
from kurt2rt.service.health.probes import Probes
from kurt2rt.service.health.status_socket import socket_of, tell_waiting
from kurt2rt.service.live_exam import LiveExam
from kurt2rt.service.open_robot import OpenedRobot, Opening, open_robot
from kurt2rt.service.post_tick import ProgramConsole, ProgramStatus
from kurt2rt.service.process_context import ProcessContext
from kurt2rt.service.serve import ChannelOptions, serve
from kurt2rt.service.settings import ServiceSettings, for_a_unit
from kurt2rt.service.shutdown import ShutdownHandler, ShutdownStage, force_exit
from kurt2rt.service.startup import AGAIN_S, Dependency, StartupGate, require_folder
from kurt2rt.service.status_line import status_line
from kurt2rt.service.systemd.notifier import Notifier

if TYPE_CHECKING:
    from hal.simulation import Simulation
    from kurt2rt.service.live_measure import LiveMeasure
    from kurt2rt.service.simulated_runs import SimulatedRuns

_KNOWLEDGE = "knowledge"
_SIMULATOR_S = 0.5
"""A simulator that is there sends within 10 ms."""


@dataclass(frozen=True, slots=True)
class RunOptions:
    """What the command line says beside the settings."""

    bus: str
    settings: str
    """Name or path of the runtime settings, for the companions."""
    as_service: bool
    """A service manager started it."""
    attended: bool
    """Teachers come over the channel."""
    stopped: bool
    """It stands until its teacher says Go."""
    behaviour: str | None
    page: bool
    phones: bool
    """The page is for phones as well: open to the network while a device is paired."""
    auto: bool
    page_port: int | None
    can_log: Path | None
    record: bool
    """To the folder that the settings name."""
    live_view: tuple[str, int] | None
    """Host and port."""
    seconds: float | None
    seed: int
    wire: str


class ProgramScreen(Protocol):
    """Output of the program. The printer's thread calls all methods while it runs; only `links` is of the loop."""

    @property
    def links(self) -> tuple[str, ...]:
        """Links to the teacher's page, with their tokens."""
        ...

    def tell(self, text: str, style: str | None = None) -> None:
        """Print a line. `style`: red for an error, yellow for a warning, another colour of rich, or None."""
        ...

    def taught(self, text: str) -> None:
        """Tell that a lesson is durable, in words."""
        ...

    def show(self, status: ProgramStatus, health: Health, trouble: str) -> None:
        """Show the status. `trouble`: of simulator and CAN log; empty where neither has any."""
        ...

    def page_line(self, line: str) -> None:
        """Take a line that the page's program printed."""
        ...

    def close(self) -> None:
        """Remove what stays in place."""
        ...


class RobotProgram:
    """One run in real time, from the first look at the bus to the last word on the screen."""

    def __init__(
        self,
        orders: RunOptions,
        read: Callable[[], ServiceSettings],
        robot: RobotSettings,
        task: TaskSettings,
        screen: ProgramScreen,
        *,
        opening: Opening = open_robot,
        give_up: Callable[[ShutdownStage], None] | None = force_exit,
        again_s: float = AGAIN_S,
    ) -> None:
        """`read`: the runtime settings, as the command line changes them. `opening` gives the robot.

        `give_up`: as ShutdownHandler. `again_s`: seconds between two attempts to find what is missing.

        Raises SettingsError.
        """
        self._orders = orders
        self._settings_of = read
        self._service = self._read()
        self._robot = robot
        self._task = task
        self._opening = opening
        self._screen = screen
        self._give_up = give_up
        self._again_s = again_s
        self._around = ExitStack()
        self._of_run = ExitStack()
        self._runs: SimulatedRuns | None = None
        self._ends_at_s = math.inf
        self._log: CanLog | None = None
        self._opened: OpenedRobot | None = None
        self._knowledge: OpenedKnowledge | None = None

    def _read(self) -> ServiceSettings:
        """Return the settings as they are now. Raises SettingsError."""
        settings = self._settings_of()
        return for_a_unit(settings) if self._orders.as_service else settings

    def run(self) -> None:
        """Run until a user or a signal ends it. Raises what `serve` and `open_robot` do."""
        service, orders = self._service, self._orders
        pin_mmap_threshold()
        end = "" if orders.as_service else "; Ctrl-C ends"
        self._screen.tell(f"task {self._task.name}, robot {orders.bus}, knowledge {service.knowledge}{end}")
        with self._around as around:
            notifier = around.enter_context(Notifier())
            reloading = ConfigReloader(self._read, service, notifier, self._say) if orders.as_service else None
            others = {} if reloading is None else {signal.SIGHUP: reloading.ask}
            ending = around.enter_context(ShutdownHandler(others=others, give_up=self._give_up))
            self._upkeep = ProcessContext(ending, notifier, reloading, self._parts(), self._guards, self._say)
            self._companions = around.enter_context(ChildProcesses(orders.settings, ending.patience_s, self._say))
            self._printer = around.enter_context(ConsoleThread(ending.patience_s))
            around.callback(self._printer.put, self._screen.close)
            last = anyio.run(self._serve)
            service = self._service
            ending.stage = ShutdownStage.BUS_AND_LOGS
        ending.stage = ShutdownStage.DISK
        # Else the interpreter walks all that there is once more, a third of a second, before the process ends.
        gc.freeze()
        count = "" if last is None else f"; {len(last.runtime.level.system)} RLAs are in {service.knowledge}"
        if self._log is not None:
            self._screen.tell(self._log.trouble or f"{self._log.written} frames are in {self._log.name}")
        self._screen.tell(f"the robot stands{count}")

    async def _serve(self) -> ProgramStatus | None:
        """One run after the other: a teacher of a simulated robot may want another world, task or knowledge file."""
        if self._orders.seconds is not None:
            self._ends_at_s = time.monotonic() + self._orders.seconds
        while True:
            with ExitStack() as self._of_run:
                last = await self._serve_run()
            runs = self._runs
            if runs is None or runs.next is None or self._upkeep.ending.asked:
                return last
            self._advance(runs)

    def _advance(self, runs: "SimulatedRuns") -> None:
        try:
            told = runs.advance()
            if told:
                self._say(told)
        except KnowledgeError as error:
            self._say(f"the next run goes on in the same knowledge: {error}", "red")
        run = runs.present
        update = {"world": run.world, "task": run.task_name, "knowledge": str(run.knowledge)}
        self._service = self._service.model_copy(update=update)
        self._task, self._knowledge, self._opened = run.task, None, None
        self._say(f"world {run.world}, task {run.task.name}, knowledge {run.knowledge}")

    async def _serve_run(self) -> ProgramStatus | None:
        orders, ending = self._orders, self._upkeep.ending
        self._upkeep.notifier.ready()
        if orders.as_service:
            with anyio.CancelScope() as waiting:
                await self._start(waiting)
            if waiting.cancelled_caught:
                return None
        else:
            self._take_robot()
            if orders.attended:
                self._pair()
        opened = self._opened
        assert opened is not None
        ending.stage = ShutdownStage.RUNTIME
        if self._service.priority:  # not before the second guard is there
            self._say(take_real_time_priority(self._service.priority, self._guards()))
        self._upkeep.notifier.ping()  # the next one comes from the first tick
        run = None
        if opened.ground is not None:
            self._runs = self._runs or self._simulated_runs(opened)
            run = self._runs.present
        openness = ChannelOptions(
            lambda: opened.robot.health.trouble,
            opened.ground,
            self._listening,
            self._exam(opened),
            self._runs,
            opened.world,
            None if opened.simulation is None else self._measure(opened.simulation),
            () if run is None else run.begin_with,
        )
        goes_on = run is not None and run.teacher is not None
        left_s = max(self._ends_at_s - time.monotonic(), self._robot.can.cycle_s)
        return await serve(
            opened.robot,
            self._robot,
            self._service,
            self._task,
            ProgramConsole(status=self._show, question=self._question, settled=self._settled, taught=self._taught),
            openness=openness if orders.attended else None,
            duration_s=left_s if math.isfinite(left_s) else None,
            stopped=orders.stopped or goes_on,
            behaviour=None if goes_on else orders.behaviour,
            instruments=self._instruments(opened),
            upkeep=self._upkeep,
            knowledge=self._knowledge,
            recording=self._recording(opened),
            tolerates_stalls=opened.ground is not None,
        )

    async def _start(self, waiting: anyio.CancelScope) -> None:
        """Wait until all is there, or until the program is told to end: then the scope is cancelled."""
        loop = asyncio.get_running_loop()
        needs = (
            Dependency("bus", self._take_robot),
            Dependency(_KNOWLEDGE, self._take_knowledge),
            Dependency("teachers' keys", self._pair),
            Dependency("network", self._look_at_port),
            *((Dependency("recordings", self._look_at_recordings),) if self._orders.record else ()),
        )
        start = StartupGate(needs, self._upkeep.notifier, self._say, self._hold, self._again_s)
        with self._upkeep.ending.first(self._brake, lambda: loop.call_soon_threadsafe(waiting.cancel)):
            try:
                async with anyio.create_task_group() as tasks:
                    tasks.start_soon(self._tell_waiting, start)
                    await start.wait()
                    tasks.cancel_scope.cancel()
            except BaseException:
                if self._knowledge is not None:
                    self._knowledge.journal.close()
                raise
        if self._opened is not None:
            self._opened.robot.release()

    async def _tell_waiting(self, start: StartupGate) -> None:
        """As soon as the knowledge is this program's: the status of whoever else teaches on in it is not ours."""
        await start.until(_KNOWLEDGE)
        await tell_waiting(socket_of(Path(self._service.knowledge)), lambda: start.waits_for)

    def _hold(self) -> None:
        """Have a robot stand that is there before the rest, and look whether its bus still is."""
        if self._opened is not None:
            self._opened.robot.sense(time.monotonic())
        self._brake()

    def _brake(self) -> None:
        if self._opened is not None:
            self._opened.robot.emergency_stop(GuardReason.PROGRAM_WAITS)

    def _take_robot(self) -> None:
        orders = self._orders
        if self._log is None and orders.can_log is not None:
            self._log = self._around.enter_context(open_can_log(orders.can_log, orders.bus))
        opening = self._opening(self._robot, orders.bus, self._service.world, orders.seed, self._log, orders.wire)
        self._opened = self._of_run.enter_context(opening)

    def _take_knowledge(self) -> None:
        path = Path(self._service.knowledge)
        require_folder(path.parent)
        self._knowledge = open_for_teaching(path, self._robot, self._task)

    def _pair(self) -> None:
        """Let programs of this machine in."""
        service = self._service
        if self._orders.as_service:
            for folder in (Path(service.teachers), Path(service.devices)):
                require_folder(folder)
        for name in sorted(OF_THIS_MACHINE):
            local_pairing(Path(service.teachers), Path(service.devices), name, port=service.port)

    def _look_at_recordings(self) -> None:
        require_folder(Path(self._service.recordings))

    def _look_at_port(self) -> None:
        nobody_paired = OF_THIS_MACHINE.issuperset(pairing_names(Path(self._service.teachers)))
        require_port(LOOPBACK if nobody_paired else EVERYWHERE, self._service.port)

    def _listening(self, channel: Channel) -> None:
        orders, port = self._orders, str(channel.endpoint.port)
        # Of the next run too: the page looks for the robot there.
        self._service = self._service.model_copy(update={"port": channel.endpoint.port})
        if self._runs is not None and self._runs.present.teacher is not None:
            return
        at = () if orders.page_port is None else ("--page-port", str(orders.page_port))
        self._say(f"teachers are listened to on UDP port {port}", "cyan")
        if orders.page:
            phones = ("--phone",) if orders.phones else ()
            words = ("teach", "--pages-as-json", *phones, "--port", port, *at)
            self._companions.start("the teacher's page", *words, lasts=True, hear=self._hear_page)
        if orders.auto:
            words = ("teach", "--auto", "--port", port, "--task", self._service.task)
            self._companions.start("the scripted teacher", *words, lasts=False)

    def _parts(self) -> dict[str, Callable[[], bool]]:
        """What has to be alive, beside what the service looks after."""
        return {
            "second guard": lambda: self._opened is None or self._opened.robot.watchdog.running,
            "simulator": lambda: self._opened is None or self._opened.lives(),
        }

    def _guards(self) -> tuple[Thread, ...]:
        """Who brakes the robot when the loop hangs, and who ends it."""
        watchdog = None if self._opened is None else self._opened.robot.watchdog.thread
        return (self._upkeep.ending.thread, *(() if watchdog is None else (watchdog,)))

    def _instruments(self, opened: OpenedRobot) -> Probes:
        log = self._log
        drops = {"lines for the terminal": lambda: self._printer.dropped}
        says = {"companions": lambda: self._companions.trouble}
        if log is not None:
            drops["frames for the CAN log"], says["CAN log"] = lambda: log.lost, lambda: log.trouble
        folders = {"recordings": Path(self._service.recordings)} if self._orders.record else {}
        return Probes(lambda: opened.robot.health, drops, says, folders, lambda: self._screen.links)

    def _exam(self, opened: OpenedRobot) -> LiveExam | None:
        if opened.ground is None:
            return None
        words = (self._service.robot, self._service.task, str(self._orders.seed))

        def command(knowledge: Path, picture: Path) -> Sequence[str]:
            # Without -P the present folder would be searched for modules.
            return (sys.executable, "-P", "-m", "kurt2rt.cli.exam_process", str(knowledge), str(picture), *words)

        return self._of_run.enter_context(LiveExam(command))

    def _measure(self, simulation: "Simulation") -> "LiveMeasure":
        from kurt2rt.service.live_measure import LiveMeasure

        return LiveMeasure(self._task, simulation)

    def _simulated_runs(self, opened: OpenedRobot) -> "SimulatedRuns":
        # Here, because a real robot needs none of it.
        from kurt2rt.service.simulated_runs import SimulatedRun, SimulatedRuns

        service = self._service
        first = SimulatedRun(service.world, self._task, service.task, Path(service.knowledge))
        assert opened.require_world is not None
        return SimulatedRuns(self._robot, first, opened.require_world, taught_by_script=self._orders.auto)

    def _recording(self, opened: OpenedRobot) -> Recording | None:
        orders, service = self._orders, self._service
        if not orders.record and orders.live_view is None:
            return None
        return Recording(
            Path(service.recordings) if orders.record else None,
            budget_of(service.recordings_mb),
            orders.bus,
            opened.ground,
            orders.live_view,
            self._say,
        )

    def _question(self, question: Question | MidQuestion) -> None:
        self._say(str(question), "yellow")

    def _settled(self, acknowledgement: Acknowledgement) -> None:
        if acknowledgement.error is not None:
            self._say(f"not saved: {acknowledgement.command_id}: {acknowledgement.error}", "red")

    def _taught(self, text: str) -> None:
        self._printer.put(lambda: self._screen.taught(text))

    def _hear_page(self, line: str) -> None:
        self._printer.put(lambda: self._screen.page_line(line))

    def _show(self, status: ProgramStatus) -> None:
        # The line is made by the printer as well: the percentiles in it cost more than a tick.
        self._printer.put(lambda: self._show_now(status))

    def _show_now(self, status: ProgramStatus) -> None:
        assert self._opened is not None
        health = self._opened.robot.health
        log_trouble = "" if self._log is None else self._log.trouble
        trouble = " | ".join(filter(None, (self._no_simulator(health, status.record.tick), log_trouble)))
        if self._orders.as_service:
            self._upkeep.notifier.status(status_line(status, health, trouble))
        self._screen.show(status, health, trouble)

    def _no_simulator(self, health: Health, tick: int) -> str:
        """Return which command is missing on a shared bus on which nothing was ever heard; empty where it is there."""
        bus = self._orders.bus
        if not bus.startswith(SHARED) or health.frames or tick * self._robot.can.cycle_s < _SIMULATOR_S:
            return ""
        return f"no simulator on {bus}; start one in another terminal: kurt2rt sim --bus {bus}"

    def _say(self, text: str, style: str | None = None) -> None:
        self._printer.put(lambda: self._screen.tell(text, style))
