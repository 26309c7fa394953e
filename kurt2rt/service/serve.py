"""The service: the runtime in real time, until somebody ends it."""

import secrets
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import ExitStack, asynccontextmanager, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import anyio

from hal.guard_reason import GuardReason
from hal.robot import Robot
from hal.robot_settings import RobotSettings
from hal.simulation import SimulatedWorld
from kurt2rt.channel.protocol.health_codec import plain_of
from kurt2rt.channel.protocol.requests import BOOT_BYTES, FASTEST
from kurt2rt.channel.security.paired_devices import Teachers
from kurt2rt.channel.server.channel import Channel, ChannelDependencies, open_channel
from kurt2rt.channel.server.simulation import RunControl
from kurt2rt.channel.server.state_builder import JournalStatus
from kurt2rt.core.decision.active_behaviour import ActiveBehaviour
from kurt2rt.core.decision.active_stop import NEXT_RUN, STARTED
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import Command
from kurt2rt.core.tick import TickRecord
from kurt2rt.knowledge.exchange.package import package_knowledge
from kurt2rt.knowledge.files.backup import BackupService
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import OpenedKnowledge, open_for_teaching
from kurt2rt.knowledge.journal.writer import JournalWriter, utc_now
from kurt2rt.platform.clock import Clock
from kurt2rt.platform.gc_control import gc_frozen
from kurt2rt.platform.realtime_priority import set_sched_fifo
from kurt2rt.platform.simulated_clock import HeldWorld, SimulatedClock, Speed
from kurt2rt.platform.switch_interval import short_switch_interval
from kurt2rt.platform.timerfd_clock import TimerfdClock
from kurt2rt.runs.recording.recorder import RunRecorder
from kurt2rt.runs.recording.recording import Recording, RunContext
from kurt2rt.runtime import Runtime, build_runtime
from kurt2rt.service.health.monitor import HealthMonitor
from kurt2rt.service.health.probes import Probes
from kurt2rt.service.health.status_socket import StatusSocket, status_socket_path
from kurt2rt.service.live_exam import LiveExam
from kurt2rt.service.live_measure import LiveMeasure
from kurt2rt.service.post_tick import PostTick, ProgramConsole, ProgramStatus, TickCallback
from kurt2rt.service.process_context import ProcessContext
from kurt2rt.service.settings import ServiceSettings
from kurt2rt.service.shutdown import ShutdownHandler, ShutdownStage
from kurt2rt.service.systemd.notifier import Notifier
from kurt2rt.service.systemd.watchdog import WatchdogNotifier

_RECORDING_S = 2.0
"""For the disk to keep the end of the recording."""
_JOURNAL_S = 10.0
"""For the disk to keep the last lessons, where nobody told the program to end."""
_KEYS_S = 0.3
"""For the counters of the teachers' messages, which the next start can do without."""


@dataclass(frozen=True, slots=True)
class ChannelOptions:
    """How the robot is open to teachers over the network."""

    bus_trouble: Callable[[], str]
    """What is wrong with the robot's bus, in a line; empty when nothing is."""
    simulated_world: SimulatedWorld | None
    """Of a simulated robot."""
    on_open: Callable[[Channel], None]
    """Called when the channel is open."""
    exam: LiveExam | None = None
    """Of a robot that is simulated in this program."""
    run_control: RunControl | None = None
    """The same."""
    held_world: HeldWorld | None = None
    """The same, where robot time may pass faster than real time."""
    measure: LiveMeasure | None = None
    """The same: how far the robot came with its task."""
    first_commands: tuple[Command, ...] = ()
    """Commands of the first tick: they let the teacher of the run before teach on."""


async def serve(
    robot: Robot,
    settings: RobotSettings,
    service: ServiceSettings,
    task: TaskSettings,
    screen: ProgramConsole,
    *,
    teacher: TickCallback | None = None,
    openness: ChannelOptions | None = None,
    duration_s: float | None,
    stopped: bool = False,
    behaviour: str | None = None,
    instruments: Probes | None = None,
    upkeep: ProcessContext | None = None,
    knowledge: OpenedKnowledge | None = None,
    recording: Recording | None = None,
    tolerates_stalls: bool = False,
) -> ProgramStatus | None:
    """Run until a signal ends it, Ctrl-Z too, or for `duration_s`; the wheels stand before anything else ends.

    `teacher`: one inside this program. `openness`: teachers over the network; then the robot needs one who is there.
    `stopped`: stand until the teacher says resume, as after a stop. `behaviour`: the one that is wanted at first.
    `instruments`: what the health report reads beside the runtime. `upkeep`: of the program around, with a service
    manager perhaps. `knowledge`: that of the settings, where it is open already; it is closed here.
    `recording`: what is kept of the run; None: nothing. `tolerates_stalls`: of a robot simulated in this program.
    Returns the last status, None when no tick ran. Raises KnowledgeError, SettingsError, UnknownActionError,
    UnknownBehaviourError, ChannelError; ValueError for a behaviour that the task does not teach.
    """
    path = Path(service.knowledge)
    wanted = ActiveBehaviour(task.behaviours)
    if behaviour is not None:
        wanted.select(behaviour)
    with ExitStack() as around:
        clock: Clock = around.enter_context(TimerfdClock())
        speed = None
        if openness is not None and openness.held_world is not None:
            clock = speed = SimulatedClock(clock, openness.held_world, FASTEST)
        upkeep = upkeep or ProcessContext(around.enter_context(ShutdownHandler()), Notifier({}))
        ending = upkeep.shutdown
        opened = knowledge or open_for_teaching(path, settings, task)
        stamps = opened.stamps
        boot = secrets.token_bytes(BOOT_BYTES)
        measure = None if openness is None else openness.measure
        begin_with = () if openness is None else openness.first_commands
        stop = None if not stopped else NEXT_RUN if begin_with else STARTED
        circumstances = RunContext(
            boot.hex(),
            str(path),
            openness is not None,
            stop,
            behaviour or "",
            tolerates_stalls=tolerates_stalls,
        )
        recorder = None
        if recording is not None:
            recorder = around.enter_context(_recording(recording, settings, task, opened, circumstances, ending))
        with _writing(opened.journal, ending) as writer:
            runtime = build_runtime(
                robot,
                settings,
                task,
                opened.events,
                writer,
                clock,
                statistics=opened.counter,
                attended=openness is not None,
                active_behaviour=wanted,
                checkpoint=opened.saved,
                tolerates_stalls=tolerates_stalls,
            )
            if stop is not None:
                runtime.handler.stop(stop)
            for command in begin_with:
                runtime.inbox.put(command)
            watch = HealthMonitor(
                runtime,
                writer,
                instruments or Probes(),
                boot=boot.hex(),
                knowledge=path,
                tolerates_stalls=tolerates_stalls,
            )
            status = StatusSocket(watch, status_socket_path(path), (instruments or Probes()).pages)
            watch.include(errors={"status": lambda: status.trouble})
            if recorder is not None:
                watch.include(
                    drops={"the recording": lambda: recorder.dropped}, errors={"recording": lambda: recorder.trouble}
                )
                watch.add_listener(lambda report: recorder.on_health(plain_of(report)))
            parts = {"knowledge journal": lambda: writer.is_alive, **upkeep.liveness}
            heartbeat = WatchdogNotifier(upkeep.notifier, settings.can.cycle_s, parts, upkeep.log)
            async with (
                anyio.create_task_group() as tasks,
                _channel(runtime, writer, stamps, service, openness, boot, watch, ending, speed) as channel,
            ):
                rounds = PostTick(runtime, writer, stamps, service, screen, teacher, channel, watch, recorder)

                def after_tick(record: TickRecord) -> None:
                    rounds(record)
                    if measure is not None:
                        measure.on_tick(record)
                    heartbeat.on_tick(record.now_s)

                tasks.start_soon(status.serve)
                if upkeep.reloader is not None:
                    tasks.start_soon(upkeep.reloader.serve, _SettingsApplier(rounds, service, upkeep))
                ticks = None if duration_s is None else round(duration_s / settings.can.cycle_s)
                # The wheels first, also where the loop hangs.
                stop_wheels = partial(robot.emergency_stop, GuardReason.SERVICE_ENDS)
                acts = (stop_wheels, runtime.scheduler.end, upkeep.notifier.stopping)
                ending.stage = ShutdownStage.LOOP
                with gc_frozen(), short_switch_interval(), watch, ending.on_shutdown(*acts):
                    try:
                        await runtime.scheduler.run(ticks, after_tick)
                    finally:
                        stop_wheels()
                ending.stage = ShutdownStage.CHANNEL
                tasks.cancel_scope.cancel()
            rounds.save_statistics()
            ending.stage = ShutdownStage.LESSONS
        for acknowledgement in writer.acknowledged():
            if recorder is not None:
                recorder.on_acknowledged(acknowledgement)
            screen.acknowledged(acknowledgement)
        ending.stage = ShutdownStage.RECORDING
    return rounds.last


@asynccontextmanager
async def _channel(
    runtime: Runtime,
    writer: JournalWriter,
    stamps: dict[str, str],
    service: ServiceSettings,
    openness: ChannelOptions | None,
    boot: bytes,
    watch: HealthMonitor,
    ending: ShutdownHandler,
    speed: Speed | None,
) -> AsyncIterator[Channel | None]:
    if openness is None:
        yield None
        return
    safekeeping = JournalStatus(
        unsaved=lambda: writer.unwritten,
        trouble=lambda: writer.error,
        stamp_of=lambda command_id: stamps.get(command_id, ""),
    )
    package = partial(package_knowledge, robot=runtime.robot, task=runtime.task)
    exam = openness.exam
    safe = BackupService(Path(service.knowledge), writer, package, None if exam is None else exam.begin)
    surroundings = ChannelDependencies(
        safekeeping,
        safe,
        openness.bus_trouble,
        openness.simulated_world,
        boot=boot,
        health=lambda: watch.newest,
        exam=None if exam is None else lambda: exam.status,
        simulation=openness.run_control,
        speed=speed,
        measure=openness.measure,
    )
    teachers = await anyio.to_thread.run_sync(Teachers, Path(service.teachers))
    try:
        async with open_channel(runtime, teachers, service.port, surroundings) as channel:
            watch.include(
                drops={"pictures for teachers": lambda: channel.pictures_skipped},
                errors={"channel": lambda: channel.trouble},
            )
            openness.on_open(channel)
            yield channel
    finally:
        # In a thread, for the disk may hang; what was reserved and not used is skipped at the next start.
        with anyio.move_on_after(ending.remaining_s(_KEYS_S), shield=True):
            await anyio.to_thread.run_sync(teachers.close, abandon_on_cancel=True)


@contextmanager
def _writing(journal: Journal, ending: ShutdownHandler) -> Iterator[JournalWriter]:
    writer = JournalWriter(journal, utc_now)
    try:
        yield writer
    finally:
        writer.close(ending.remaining_s(_JOURNAL_S))


@contextmanager
def _recording(
    recording: Recording,
    settings: RobotSettings,
    task: TaskSettings,
    knowledge: OpenedKnowledge,
    circumstances: RunContext,
    ending: ShutdownHandler,
) -> Iterator[RunRecorder]:
    recorder = recording.recorder(settings, task, knowledge, circumstances)
    recorder.start()
    try:
        yield recorder
    finally:
        recorder.close(ending.remaining_s(_RECORDING_S))
        recording.ended(recorder)


class _SettingsApplier:
    """Takes settings that were read anew."""

    def __init__(self, rounds: PostTick, service: ServiceSettings, upkeep: ProcessContext) -> None:
        self._rounds = rounds
        self._priority = service.priority
        self._upkeep = upkeep

    def __call__(self, service: ServiceSettings) -> None:
        self._rounds.apply_settings(service)
        if service.priority != self._priority:
            self._priority = service.priority
            self._upkeep.log(set_sched_fifo(self._priority, self._upkeep.guard_threads()))
