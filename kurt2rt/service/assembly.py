"""Assembly of a robot's service: runtime, journal writer and channel."""

import math
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import anyio
import anyio.to_thread

from hal.robot import Robot
from hal.robot_settings import RobotSettings
from kurt2rt.channel.security.paired_devices import Teachers
from kurt2rt.channel.server.channel import Channel, open_channel
from kurt2rt.channel.server.dependencies import ChannelDependencies, JournalStatus
from kurt2rt.core.decision.decision import ActiveBehaviour
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.knowledge.exchange.package import package_knowledge
from kurt2rt.knowledge.files.backup import BackupService
from kurt2rt.knowledge.journal.loading import OpenedKnowledge
from kurt2rt.knowledge.journal.writer import JournalWriter
from kurt2rt.platform.clock import Clock
from kurt2rt.runs.recording.recording import RunContext
from kurt2rt.runtime import Runtime, RuntimeOptions, build_runtime
from kurt2rt.service.live_exam import LiveExam
from kurt2rt.service.settings import ServiceSettings


@dataclass(frozen=True, slots=True)
class RunSettings:
    """Settings that one run of the service needs: those of robot, task and service."""

    robot: RobotSettings
    task: TaskSettings
    service: ServiceSettings


@dataclass(frozen=True, slots=True)
class RobotService:
    """Assembled runtime of one robot, and the thread that writes its lessons."""

    runtime: Runtime
    writer: JournalWriter
    settings: ServiceSettings
    stamps: dict[str, str] = field(default_factory=dict)
    """UTC time of each durable lesson, by command id; `PostTick` adds new lessons."""

    def channel_dependencies(self, exam: LiveExam | None = None) -> ChannelDependencies:
        """Return the parts of the service that the channel reads: journal, knowledge's copies and packages, exam.

        `exam`: None: no exams.
        """
        runtime, writer = self.runtime, self.writer
        journal = JournalStatus(
            unsaved=lambda: writer.unwritten,
            saving_error=lambda: writer.saving_error,
            stamp_of=lambda command_id: self.stamps.get(command_id, ""),
        )
        package = partial(package_knowledge, robot=runtime.robot, task=runtime.task)
        knowledge = Path(self.settings.knowledge)
        if exam is None:
            return ChannelDependencies(journal, BackupService(knowledge, writer, package), lambda: "", None)
        copies = BackupService(knowledge, writer, package, exam.begin, exam.picture)
        return ChannelDependencies(journal, copies, lambda: "", None, exam=lambda: exam.status)


def assemble_service(
    robot: Robot,
    settings: RunSettings,
    knowledge: OpenedKnowledge,
    writer: JournalWriter,
    clock: Clock,
    context: RunContext,
) -> RobotService:
    """Build the runtime with the knowledge, its behaviour and its stop as `context` says.

    Args:
        robot: interface that the runtime senses and drives with.
        settings: robot, task and service of the run.
        knowledge: events, counters and values of the knowledge file.
        writer: thread that appends lessons to that file.
        clock: time of the ticks.
        context: boot id, stop, behaviour and attendance of the run.

    Raises:
        SettingsError: situation, critic or mid level of the task cannot be loaded.
        UnknownActionError: the knowledge names an action that the task's repertoire lacks.
        UnknownBehaviourError: the knowledge names a behaviour that the task lacks.
        CommandRefusedError: the task does not teach `context.behaviour`.
        ValueError: a saved expectation has another number of features.
    """
    behaviour = ActiveBehaviour(settings.task.behaviours)
    if context.behaviour:
        behaviour.select(context.behaviour)
    runtime = build_runtime(
        robot,
        settings.robot,
        settings.task,
        knowledge.events,
        writer,
        clock,
        RuntimeOptions(
            statistics=knowledge.counter,
            attended=context.attended,
            active_behaviour=behaviour,
            checkpoint=knowledge.saved,
            tolerates_stalls=context.tolerates_stalls,
        ),
    )
    if context.stopped is not None:
        runtime.handler.control.stop(context.stopped)
    return RobotService(runtime, writer, settings.service, knowledge.stamps)


@asynccontextmanager
async def open_service_channel(
    service: RobotService, dependencies: ChannelDependencies, close_within_s: Callable[[], float] = lambda: math.inf
) -> AsyncIterator[Channel]:
    """Open the channel for the paired devices of the settings; close their files at the end.

    `close_within_s`: returns the seconds that a hanging disk may take then. Raises ChannelError, CredentialsError.
    """
    settings = service.settings
    teachers = await anyio.to_thread.run_sync(Teachers, Path(settings.teachers))
    try:
        async with open_channel(service.runtime, teachers, settings.port, dependencies) as channel:
            yield channel
    finally:
        # In a thread, for the disk may hang. Reserved counters that were not used are skipped at the next start.
        with anyio.move_on_after(close_within_s(), shield=True):
            await anyio.to_thread.run_sync(teachers.close, abandon_on_cancel=True)
