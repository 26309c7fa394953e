"""Robot program: robot, CAN log and child processes around the service."""

import gc
import math
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

import anyio

from hal.health import Health
from hal.robot_settings import RobotSettings
from kurt2rt.channel.server.channel import Channel
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.question import MidQuestion, Question
from kurt2rt.knowledge.journal.loading import OpenedKnowledge
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.memory import pin_mmap_threshold
from kurt2rt.platform.realtime_priority import set_sched_fifo
from kurt2rt.runs.recording.can_log import CanLog, open_can_log
from kurt2rt.runs.recording.recording import Recording
from kurt2rt.runs.recording.run_folder import budget_of
from kurt2rt.service.assembly import RunSettings
from kurt2rt.service.bus_names import SHARED
from kurt2rt.service.child_processes import ChildProcesses
from kurt2rt.service.console_thread import ConsoleThread
from kurt2rt.service.health.probes import Probes
from kurt2rt.service.live_exam import LiveExam
from kurt2rt.service.open_robot import OpenedRobot
from kurt2rt.service.post_tick import ProgramConsole, ProgramStatus
from kurt2rt.service.program_screen import ProgramScreen
from kurt2rt.service.program_startup import ProgramStartup
from kurt2rt.service.run_options import ProgramEnvironment, RunOptions
from kurt2rt.service.serve import ChannelOptions, ServeOptions, serve
from kurt2rt.service.settings import ServiceSettings, with_unit_priority
from kurt2rt.service.shutdown import ProcessContext, ShutdownHandler, ShutdownStage
from kurt2rt.service.status_line import status_line
from kurt2rt.service.systemd.notifier import Notifier

if TYPE_CHECKING:
    from kurt2rt.service.live_measure import LiveMeasure
    from kurt2rt.service.simulated_runs import SimulatedRuns
    from simbridge.contracts.simulation import Simulation

_SIMULATOR_S = 0.5
"""A simulator that is there sends within 10 ms."""


class RobotProgram:
    """Robot program in real time, from the opening of the bus to the last line on the screen."""

    def __init__(
        self,
        options: RunOptions,
        settings: ServiceSettings,
        robot: RobotSettings,
        task: TaskSettings,
        screen: ProgramScreen,
        environment: ProgramEnvironment | None = None,
    ) -> None:
        """Open nothing before `run`.

        Args:
            options: options of the command line.
            settings: runtime settings with the command line applied to them.
            robot: settings of the robot.
            task: task of the first run.
            screen: output of the program.
            environment: opener of the robot and times; None: those of `kurt2rt run`.
        """
        self._options = options
        self._service = with_unit_priority(settings) if options.as_service else settings
        self._robot = robot
        self._task = task
        self._screen = screen
        self._environment = environment or ProgramEnvironment()
        self._program_stack = ExitStack()
        self._run_stack = ExitStack()
        self._simulated: SimulatedRuns | None = None
        self._ends_at_s = math.inf
        self._can_log: CanLog | None = None
        self._startup: ProgramStartup | None = None
        """Startup of the present run; None before the first one, and from a run's end to the next one."""

    def run(self) -> None:
        """Run until a user or a signal ends it.

        Raises the errors of `kurt2rt.service.serve.serve`, and BusError if the robot cannot be opened.
        """
        service, options = self._service, self._options
        pin_mmap_threshold()
        end = "" if options.as_service else "; Ctrl-C ends"
        with self._program_stack as stack:
            notifier = stack.enter_context(Notifier())
            shutdown = stack.enter_context(ShutdownHandler(on_timeout=self._environment.on_timeout))
            # Not before: a reader of the line may send a signal at once.
            self._screen.print_line(f"task {self._task.name}, robot {options.bus}, knowledge {service.knowledge}{end}")
            self._context = ProcessContext(shutdown, notifier, self._liveness(), self._log)
            self._children = stack.enter_context(ChildProcesses(shutdown.remaining_s, self._log))
            self._printer = stack.enter_context(ConsoleThread(shutdown.remaining_s))
            stack.callback(self._printer.submit, self._screen.close)
            last = anyio.run(self._serve)
            shutdown.stage = ShutdownStage.BUS_AND_LOGS
        shutdown.stage = ShutdownStage.DISK
        # Else the interpreter collects everything once more before the process ends, 0.3 s.
        gc.freeze()
        count = "" if last is None else f"; {len(last.runtime.level.system)} RLAs are in {self._service.knowledge}"
        log = self._can_log
        if log is not None:
            self._screen.print_line(log.trouble or f"{log.written} frames are in {log.name}")
        self._screen.print_line(f"the robot stands{count}")

    async def _serve(self) -> ProgramStatus | None:
        """Serve one run after the other: a teacher of a simulated robot may choose another world, task or file."""
        if self._options.seconds is not None:
            self._ends_at_s = time.monotonic() + self._options.seconds
        while True:
            with ExitStack() as self._run_stack:
                last = await self._serve_run()
            runs = self._simulated
            if runs is None or runs.next is None or self._context.shutdown.requested:
                return last
            self._advance(runs)

    def _advance(self, runs: "SimulatedRuns") -> None:
        try:
            archived = runs.advance()
            if archived:
                self._log(archived)
        except KnowledgeError as error:
            self._log(f"the next run goes on in the same knowledge: {error}", "red")
        run = runs.present
        update = {"world": run.world, "task": run.task_name, "knowledge": str(run.knowledge)}
        self._service = self._service.model_copy(update=update)
        self._task, self._startup = run.task, None
        self._log(f"world {run.world}, task {run.task.name}, knowledge {run.knowledge}")

    async def _serve_run(self) -> ProgramStatus | None:
        """Open the robot and serve one run; return None if the program has to end while it waits for the robot."""
        context = self._context
        context.notifier.ready()
        settings = RunSettings(self._robot, self._task, self._service)
        self._startup = ProgramStartup(
            self._options, settings, self._environment, context, self._run_stack, self._open_can_log
        )
        opened = await self._startup.open()
        if opened is None:
            return None
        context.shutdown.stage = ShutdownStage.RUNTIME
        if self._service.priority:  # not before the watchdog runs
            self._log(set_sched_fifo(self._service.priority, self._guard_threads()))
        context.notifier.ping()  # the first tick sends the next ping
        console = ProgramConsole(
            status=self._show, question=self._question, acknowledged=self._on_acknowledged, taught=self._taught
        )
        return await serve(opened.robot, settings, console, self._serve_options(opened, self._startup.knowledge))

    @property
    def _opened(self) -> OpenedRobot | None:
        """Return the robot of the present run; None while it is not open."""
        return None if self._startup is None else self._startup.opened

    def _open_can_log(self) -> CanLog | None:
        """Return the CAN log, which is opened once for all runs; None without one."""
        options = self._options
        if self._can_log is None and options.can_log is not None:
            self._can_log = self._program_stack.enter_context(open_can_log(options.can_log, options.bus))
        return self._can_log

    def _serve_options(self, opened: OpenedRobot, knowledge: OpenedKnowledge | None) -> ServeOptions:
        options, run = self._options, None
        measure = None if opened.simulation is None else self._measure(opened.simulation)
        if opened.simulated_world is not None:
            self._simulated = self._simulated or self._simulated_runs(opened)
            run = self._simulated.present
        channel = ChannelOptions(
            bus_trouble=lambda: opened.robot.health.trouble,
            simulated_world=opened.simulated_world,
            on_open=self._on_channel_open,
            exam=self._exam(opened),
            run_control=self._simulated,
            held_world=opened.held_world,
            measure=measure,
            first_commands=() if run is None else run.first_commands,
        )
        goes_on = run is not None and run.teacher is not None
        left_s = max(self._ends_at_s - time.monotonic(), self._robot.cycle_s)
        return ServeOptions(
            channel=channel if options.attended else None,
            duration_s=left_s if math.isfinite(left_s) else None,
            stopped=options.stopped or goes_on,
            behaviour="" if goes_on else options.behaviour,
            probes=self._probes(opened, measure),
            context=self._context,
            knowledge=knowledge,
            recording=self._recording(opened),
            tolerates_stalls=opened.simulated_world is not None,
        )

    def _on_channel_open(self, channel: Channel) -> None:
        options, port = self._options, str(channel.endpoint.port)
        # For the next run, too: the page expects the robot there.
        self._service = self._service.model_copy(update={"port": channel.endpoint.port})
        if self._simulated is not None and self._simulated.present.teacher is not None:
            return
        at = () if options.page_port is None else ("--page-port", str(options.page_port))
        teach = ("teach", "--for-run", "--port", port, "--settings", options.settings)
        self._log(f"teachers are listened to on UDP port {port}", "cyan")
        if options.page:
            phones = ("--phone",) if options.phones else ()
            named = ("--page-address", self._service.page_address)
            self._children.start(
                "the teacher's page", *teach, *phones, *at, *named, restarts=True, on_line=self._on_page_line
            )
        if options.scripted_teacher is not None:
            settings, teacher = self._service, options.scripted_teacher
            of_robot = ("--task", settings.task, "--robot-settings", settings.robot)
            words = (*teach, "--auto", *of_robot, "--teacher", teacher)
            self._children.start("the scripted teacher", *words, restarts=False)

    def _liveness(self) -> dict[str, Callable[[], bool]]:
        """Return the checks of what must be alive, without the parts that the service checks."""
        return {
            "second guard": lambda: self._opened is None or self._opened.robot.watchdog.running,
            "simulator": lambda: self._opened is None or self._opened.is_alive(),
        }

    def _guard_threads(self) -> tuple[Thread, ...]:
        """Return the threads that brake the robot and end the program if the loop hangs."""
        watchdog = None if self._opened is None else self._opened.robot.watchdog.thread
        return (self._context.shutdown.thread, *(() if watchdog is None else (watchdog,)))

    def _probes(self, opened: OpenedRobot, measure: "LiveMeasure | None") -> Probes:
        log = self._can_log
        drops = {"lines for the terminal": lambda: self._printer.dropped}
        errors = {"companions": lambda: self._children.trouble, "recording": lambda: self._options.unrecorded}
        if log is not None:
            drops["frames for the CAN log"], errors["CAN log"] = lambda: log.lost, lambda: log.trouble
        folders = {"recordings": Path(self._service.recordings)} if self._options.record else {}
        reached = str if measure is None else lambda: f"{measure.progress:.1f} {measure.unit}"
        return Probes(lambda: opened.robot.health, drops, errors, folders, lambda: self._screen.links, reached)

    def _exam(self, opened: OpenedRobot) -> LiveExam | None:
        runs = self._simulated
        if opened.simulated_world is None or runs is None:
            return None
        words = (self._service.robot, self._service.task, str(self._options.seed))

        def command(knowledge: Path, picture: Path) -> Sequence[str]:
            # Without -P the present folder would be searched for modules.
            return (sys.executable, "-P", "-m", "kurt2rt.cli.exam_process", str(knowledge), str(picture), *words)

        return self._run_stack.enter_context(LiveExam(command, runs.present.knowledge))

    def _measure(self, simulation: "Simulation") -> "LiveMeasure":
        from kurt2rt.service.live_measure import LiveMeasure

        return LiveMeasure(self._task, simulation)

    def _simulated_runs(self, opened: OpenedRobot) -> "SimulatedRuns":
        # Here, because a real robot needs none of it.
        from kurt2rt.service.simulated_runs import SimulatedRun, SimulatedRuns

        service = self._service
        first = SimulatedRun(service.world, self._task, service.task, Path(service.knowledge))
        assert opened.require_world is not None
        by_script = self._options.scripted_teacher is not None
        return SimulatedRuns(self._robot, first, opened.require_world, taught_by_script=by_script)

    def _recording(self, opened: OpenedRobot) -> Recording | None:
        options, service = self._options, self._service
        if not options.record and options.live_view is None:
            return None
        return Recording(
            Path(service.recordings) if options.record else None,
            budget_of(service.recordings_mb),
            options.bus,
            opened.simulated_world,
            options.live_view,
            self._log,
        )

    def _question(self, question: Question | MidQuestion) -> None:
        self._log(str(question), "yellow")

    def _on_acknowledged(self, acknowledgement: Acknowledgement) -> None:
        if acknowledgement.error is not None:
            self._log(f"not saved: {acknowledgement.command_id}: {acknowledgement.error}", "red")

    def _taught(self, text: str) -> None:
        self._printer.submit(lambda: self._screen.lesson_saved(text))

    def _on_page_line(self, line: str) -> None:
        self._printer.submit(lambda: self._screen.page_line(line))

    def _show(self, status: ProgramStatus) -> None:
        # The line is made by the printer as well: the percentiles in it cost more than a tick.
        self._printer.submit(lambda: self._show_now(status))

    def _show_now(self, status: ProgramStatus) -> None:
        assert self._opened is not None
        health = self._opened.robot.health
        log_trouble = "" if self._can_log is None else self._can_log.trouble
        trouble = " | ".join(filter(None, (self._no_simulator(health, status.record.tick), log_trouble)))
        if self._options.as_service:
            self._context.notifier.status(status_line(status, health, trouble))
        self._screen.show_status(status, health, trouble)

    def _no_simulator(self, health: Health, tick: int) -> str:
        """Return which command is missing on a shared bus on which nothing was ever heard; empty where it is there."""
        bus = self._options.bus
        if not bus.startswith(SHARED) or health.frames or tick * self._robot.cycle_s < _SIMULATOR_S:
            return ""
        return f"no simulator on {bus}; start one in another terminal: kurt2rt sim --bus {bus}"

    def _log(self, text: str, style: str | None = None) -> None:
        self._printer.submit(lambda: self._screen.print_line(text, style))
