"""The service: the runtime in real time, until somebody ends it."""

import signal
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import anyio
import anyio.abc

from hal.robot import Robot
from hal.robot_settings import RobotSettings
from kurt2rt.knowledge.opening import go_on_teaching
from kurt2rt.knowledge.statistics import Statistics
from kurt2rt.knowledge.writer import Acknowledgement, JournalWriter, utc_now
from kurt2rt.runtime import Runtime, build_runtime
from kurt2rt.service_settings import ServiceSettings
from kurt2rt.tasks.settings import TaskSettings
from kurt2rt.teaching.commands import Command
from kurt2rt.teaching.question import Question, ask
from kurt2rt.tick import TickRecord
from kurt2rt.timing.quiet_gc import quiet_gc
from kurt2rt.timing.timerfd import TimerfdClock

Watcher = Callable[[TickRecord], Command | None]
"""Sees each tick's record and may answer with a command: a scripted teacher's `watch`."""


@dataclass(frozen=True, slots=True)
class Status:
    """How the service stands, for the one who looks at it."""

    record: TickRecord
    runtime: Runtime
    unsaved_lessons: int
    trouble: str | None


@dataclass(frozen=True, slots=True)
class Screen:
    """What the service tells. Called from the loop: none of these may wait."""

    status: Callable[[Status], None]
    """Once per status period."""
    question: Callable[[Question], None]
    """When the robot begins to ask, at most once a second: at the border of R it asks for moments at a time."""
    settled: Callable[[Acknowledgement], None]
    """A lesson is durable, or never can be, and why."""


async def serve(
    robot: Robot,
    settings: RobotSettings,
    service: ServiceSettings,
    task: TaskSettings,
    screen: Screen,
    *,
    teacher: Watcher | None,
    duration_s: float | None,
    stopped: bool = False,
) -> Status | None:
    """Run until SIGTERM, SIGINT or SIGHUP, or for `duration_s`; the wheels stand before anything else ends.

    `stopped`: stand until the teacher says resume, as after a stop.
    Returns the last status, None when no tick ran. Raises KnowledgeError, SettingsError, UnknownActionError.
    """
    last: Status | None = None
    with TimerfdClock() as clock:
        opened = go_on_teaching(Path(service.knowledge), settings, task)
        counter = opened.counter
        with JournalWriter(opened.journal, utc_now) as writer:
            runtime = build_runtime(robot, settings, task, opened.events, writer, clock, statistics=counter)
            if stopped:
                runtime.school.stop("the robot program was started")
            period_s = settings.can.cycle_s
            checkpoint_ticks = round(service.checkpoint_period_s / period_s)
            status_ticks = round(service.status_period_s / period_s)
            ticks_per_second = round(1 / period_s)
            asking = False
            asked_at = -ticks_per_second

            def after_tick(record: TickRecord) -> None:
                nonlocal last, asking, asked_at
                if teacher is not None:
                    command = teacher(record)
                    if command is not None:
                        runtime.inbox.put(command)
                if not record.decision.asking:
                    asking = False
                elif not asking and record.tick - asked_at >= ticks_per_second:
                    asking = True
                    asked_at = record.tick
                    weights, names = runtime.level.system.weights, runtime.definition.names
                    screen.question(ask(record.decision.match, record.situation.vector, weights, names))
                for acknowledgement in writer.acknowledged():
                    screen.settled(acknowledgement)
                ticks = runtime.ledger.ticks
                if ticks % checkpoint_ticks == 0:
                    writer.submit_statistics(Statistics(dict(counter.uses), dict(counter.transitions)))
                if ticks % status_ticks == 0:
                    last = Status(record, runtime, writer.unwritten, writer.trouble)
                    screen.status(last)

            async with anyio.create_task_group() as tasks:
                await tasks.start(_end_on_signal, runtime)
                ticks = None if duration_s is None else round(duration_s / period_s)
                with quiet_gc():
                    try:
                        await runtime.scheduler.run(ticks, after_tick)
                    finally:
                        robot.emergency_stop("the service ends")
                tasks.cancel_scope.cancel()
            writer.submit_statistics(Statistics(dict(counter.uses), dict(counter.transitions)))
        for acknowledgement in writer.acknowledged():
            screen.settled(acknowledgement)
    return last


async def _end_on_signal(runtime: Runtime, *, task_status: anyio.abc.TaskStatus[None]) -> None:
    with anyio.open_signal_receiver(signal.SIGTERM, signal.SIGINT, signal.SIGHUP) as signals:
        task_status.started()
        async for _ in signals:
            runtime.scheduler.end()
