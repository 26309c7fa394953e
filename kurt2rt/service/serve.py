"""Service of one run: the runtime in real time until a signal, the duration or another run ends it."""

import secrets
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import ExitStack, asynccontextmanager, contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import anyio

from behaviors.contained_behaviour import failures_of
from config.plugin_source import plugins_in_use
from hal.guard_reason import GuardReason
from hal.robot import Robot
from kurt2rt.channel.protocol.health import HEALTH
from kurt2rt.channel.protocol.limits import BOOT_BYTES, FASTEST
from kurt2rt.channel.server.channel import Channel
from kurt2rt.channel.server.dependencies import RunControl
from kurt2rt.core.decision.standing import NEXT_RUN, STARTED
from kurt2rt.core.teaching.commands import Command
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import OpenedKnowledge, open_for_teaching
from kurt2rt.knowledge.journal.writer import JournalWriter, utc_now
from kurt2rt.platform.clock import Clock
from kurt2rt.platform.gc_control import gc_frozen
from kurt2rt.platform.memory import use_huge_pages
from kurt2rt.platform.simulated_clock import HeldWorld, SimulatedClock, Speed
from kurt2rt.platform.switch_interval import short_switch_interval
from kurt2rt.platform.timerfd_clock import TimerfdClock
from kurt2rt.runs.recording.recording import Recording, RunContext
from kurt2rt.service.assembly import RobotService, RunSettings, assemble_service, open_service_channel
from kurt2rt.service.health.monitor import HealthMonitor
from kurt2rt.service.health.probes import Probes
from kurt2rt.service.health.status_socket import StatusSocket, status_socket_path
from kurt2rt.service.live_exam import LiveExam
from kurt2rt.service.live_measure import LiveMeasure
from kurt2rt.service.post_tick import PostTick, ProgramConsole, ProgramStatus, TickCallback
from kurt2rt.service.settings import ServiceSettings
from kurt2rt.service.shutdown import ProcessContext, ShutdownHandler, ShutdownStage
from kurt2rt.service.systemd.notifier import Notifier
from kurt2rt.service.systemd.watchdog import WatchdogNotifier
from simbridge.contracts.simulation import SimulatedWorld

if TYPE_CHECKING:
    from kurt2rt.runs.recording.recorder import RunRecorder

_RECORDING_S = 2.0
"""Time to write the end of the recording, unless a signal asks for less."""
_JOURNAL_S = 10.0
"""Time to write the last lessons, unless a signal asks for less."""
_KEYS_S = 0.3
"""Time to write the counters of the teachers' messages; the next start can do without them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelOptions:
    """Choices of the caller of `serve` for a run that teachers reach over the network."""

    bus_trouble: Callable[[], str] = lambda: ""
    """Returns what is wrong with the robot's bus, in a line; empty if nothing is."""
    simulated_world: SimulatedWorld | None = None
    """World of a simulated robot; None for a real robot."""
    on_open: Callable[[Channel], None] = lambda _: None
    """Called in the loop as soon as the channel is open."""
    exam: LiveExam | None = None
    """Exams of a robot simulated in this program; None: no exams."""
    run_control: RunControl | None = None
    """Choice of the next run of a robot simulated in this program."""
    held_world: HeldWorld | None = None
    """World to step, if robot time may pass faster than real time; None: robot time is real time."""
    measure: LiveMeasure | None = None
    """Progress of a robot simulated in this program, as its task measures it."""
    first_commands: tuple[Command, ...] = ()
    """Commands of the first tick: they let the teacher of the run before teach on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ServeOptions:
    """Choices of the caller of `serve` beyond robot and settings; all have defaults."""

    on_tick: TickCallback | None = None
    """Teacher inside this program; None: no such teacher."""
    channel: ChannelOptions | None = None
    """Teachers over the network: in phases 1 to 4 the robot then drives only while one is there. None: no network."""
    duration_s: float | None = None
    """Length of the run in s; None: until a signal ends it."""
    stopped: bool = False
    """True if the robot stands until its teacher says resume."""
    behaviour: str = ""
    """Behaviour at the start; empty: the first of the task."""
    probes: Probes = field(default_factory=Probes)
    """Parts of the program that the health report reads, without the runtime."""
    context: ProcessContext | None = None
    """Signals, service manager and threads of the program; None: signals only."""
    knowledge: OpenedKnowledge | None = None
    """Knowledge of the settings, if it is open already; the service closes it."""
    recording: Recording | None = None
    """Destination of the recording; None: the run is not recorded."""
    tolerates_stalls: bool = False
    """True if the robot stalls with this program, as a robot simulated in it does."""


async def serve(
    robot: Robot, settings: RunSettings, console: ProgramConsole, options: ServeOptions
) -> ProgramStatus | None:
    """Run the robot until a signal (Ctrl-Z too) or the duration ends it; stop the wheels before anything else ends.

    Returns the last status; None if no tick ran.

    Raises:
        KnowledgeError: the knowledge file cannot be opened or written.
        SettingsError: a file that the settings name cannot be loaded.
        UnknownActionError: the knowledge names an action that the task's repertoire lacks.
        UnknownBehaviourError: the knowledge names a behaviour that the task lacks.
        CommandRefusedError: the task does not teach the behaviour of the start.
        ChannelError: the UDP port cannot be opened.
        CredentialsError: the folder of pairings cannot be read.
    """
    with ExitStack() as stack:
        clock: Clock = stack.enter_context(TimerfdClock())
        speed = None
        if options.channel is not None and options.channel.held_world is not None:
            clock = speed = SimulatedClock(clock, options.channel.held_world, FASTEST)
        context = options.context or ProcessContext(stack.enter_context(ShutdownHandler()), Notifier({}))
        shutdown = context.shutdown
        path = Path(settings.service.knowledge)
        knowledge = options.knowledge or open_for_teaching(path, settings.robot, settings.task)
        run = _run_context(settings.service, options)
        recorder = None
        if options.recording is not None:
            recorder = stack.enter_context(_recording(options.recording, settings, knowledge, run, shutdown))
        with _writing(knowledge.journal, shutdown) as writer:
            service = assemble_service(robot, settings, knowledge, writer, clock, run)
            for command in () if options.channel is None else options.channel.first_commands:
                service.runtime.inbox.put(command)
            last = await _Run(robot, service, run, options, context, recorder).serve(console, speed)
            shutdown.stage = ShutdownStage.LESSONS
        for acknowledgement in writer.acknowledged():
            if recorder is not None:
                recorder.on_acknowledged(acknowledgement)
            console.acknowledged(acknowledgement)
        shutdown.stage = ShutdownStage.RECORDING
    return last


def _run_context(settings: ServiceSettings, options: ServeOptions) -> RunContext:
    goes_on = options.channel is not None and options.channel.first_commands
    return RunContext(
        secrets.token_bytes(BOOT_BYTES).hex(),
        str(Path(settings.knowledge)),
        attended=options.channel is not None,
        stopped=None if not options.stopped else NEXT_RUN if goes_on else STARTED,
        behaviour=options.behaviour,
        tolerates_stalls=options.tolerates_stalls,
    )


class _Run:
    """Ticks of one run with health report, heartbeat and channel around them."""

    def __init__(
        self,
        robot: Robot,
        service: RobotService,
        run: RunContext,
        options: ServeOptions,
        context: ProcessContext,
        recorder: "RunRecorder | None",
    ) -> None:
        self._robot = robot
        self._service = service
        self._run = run
        self._options = options
        self._context = context
        self._recorder = recorder
        knowledge, writer = Path(service.settings.knowledge), service.writer
        plugins = plugins_in_use()
        for plugin in plugins:
            context.log(f"plug-in of {plugin}")
        self._health = HealthMonitor(
            service.runtime,
            writer,
            options.probes,
            boot=run.boot,
            knowledge=knowledge,
            tolerates_stalls=run.tolerates_stalls,
            plugins=plugins,
        )
        status = self._status = StatusSocket(self._health, status_socket_path(knowledge), options.probes.pages)
        repertoire = service.runtime.level.repertoire
        self._health.include(
            errors={"status": lambda: status.trouble, "plug-ins": lambda: failures_of(repertoire.values())}
        )
        if recorder is not None:
            self._health.include(
                drops={"the recording": lambda: recorder.dropped}, errors={"recording": lambda: recorder.trouble}
            )
            self._health.add_listener(lambda report: recorder.on_health(HEALTH.plain_of(report)))
        liveness = {"knowledge journal": lambda: writer.is_alive, **context.liveness}
        period_s = service.runtime.robot.cycle_s
        self._heartbeat = WatchdogNotifier(context.notifier, period_s, liveness, context.log)

    async def serve(self, console: ProgramConsole, speed: Speed | None) -> ProgramStatus | None:
        """Open the channel, run the ticks, close the channel, hand the statistics to the journal's thread."""
        options = self._options
        async with anyio.create_task_group() as tasks, self._channel(speed) as channel:
            post_tick = PostTick(
                self._service,
                console,
                on_tick=options.on_tick,
                channel=channel,
                health=self._health,
                recorder=self._recorder,
            )
            tasks.start_soon(self._status.serve)
            await self._tick(post_tick)
            self._context.shutdown.stage = ShutdownStage.CHANNEL
            tasks.cancel_scope.cancel()
        post_tick.save_statistics()
        return post_tick.last

    async def _tick(self, post_tick: PostTick) -> None:
        options, context, runtime = self._options, self._context, self._service.runtime
        measure = None if options.channel is None else options.channel.measure

        def after_tick(record: TickRecord) -> None:
            post_tick(record)
            if measure is not None:
                measure.on_tick(record)
            self._heartbeat.on_tick(record.now_s)

        ticks = None if options.duration_s is None else round(options.duration_s / runtime.robot.cycle_s)
        # The wheels first, also if the loop hangs.
        stop_wheels = partial(self._robot.emergency_stop, GuardReason.SERVICE_ENDS)
        callbacks = (stop_wheels, runtime.scheduler.end, context.notifier.stopping)
        context.shutdown.stage = ShutdownStage.LOOP
        with gc_frozen(), short_switch_interval(), self._health, context.shutdown.on_shutdown(*callbacks):
            use_huge_pages()
            try:
                await runtime.scheduler.run(ticks, after_tick)
            finally:
                stop_wheels()

    @asynccontextmanager
    async def _channel(self, speed: Speed | None) -> AsyncIterator[Channel | None]:
        options, health, shutdown = self._options.channel, self._health, self._context.shutdown
        if options is None:
            yield None
            return
        dependencies = replace(
            self._service.channel_dependencies(options.exam),
            bus_trouble=options.bus_trouble,
            world=options.simulated_world,
            boot=bytes.fromhex(self._run.boot),
            health=lambda: health.newest,
            run_control=options.run_control,
            speed=speed,
            progress=options.measure,
        )
        async with open_service_channel(self._service, dependencies, partial(shutdown.remaining_s, _KEYS_S)) as channel:
            health.include(
                drops={"pictures for teachers": lambda: channel.states_skipped},
                errors={"channel": lambda: channel.trouble},
            )
            options.on_open(channel)
            yield channel


@contextmanager
def _writing(journal: Journal, shutdown: ShutdownHandler) -> Iterator[JournalWriter]:
    writer = JournalWriter(journal, utc_now).start()
    try:
        yield writer
    finally:
        writer.close(shutdown.remaining_s(_JOURNAL_S))


@contextmanager
def _recording(
    recording: Recording,
    settings: RunSettings,
    knowledge: OpenedKnowledge,
    run: RunContext,
    shutdown: ShutdownHandler,
) -> Iterator["RunRecorder"]:
    recorder = recording.recorder(settings.robot, settings.task, knowledge, run)
    recorder.start()
    try:
        yield recorder
    finally:
        recorder.close(shutdown.remaining_s(_RECORDING_S))
        recording.report_end(recorder)
