"""Benchmark of the time from a lesson at the device to its acknowledgement there."""

import time
from functools import partial
from pathlib import Path

from anyio import to_thread

from kurt2rt.checks.bench.helper_process import helper_process
from kurt2rt.checks.bench.open_robot import OpenRobot, open_robot
from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference
from kurt2rt.checks.bench.robot_under_test import BenchFixture, OnProgress
from kurt2rt.core.teaching.commands import Teach
from kurt2rt.experiments.lockstep.lesson_keeping import LessonLostError
from kurt2rt.platform.ledger import percentiles_of

P99_LIMIT_US = 35_000.0
"""Limit: 20 ms to durability, 10 ms to the next tick, the rest for the network."""
_LESSONS_AT_ONCE = 10
_WARMING_UP = 1
_PATIENCE_S = 10.0


async def measure_channel_lessons(
    fixture: BenchFixture, folder: Path, lessons: int, on_progress: OnProgress
) -> BenchResult:
    """Measure the time from a device's answer to its acknowledgement; files go to `folder`.

    Alternates with lessons inside the robot's program. Raises LessonLostError, KnowledgeError, ChannelError,
    CredentialsError, HelperLostError, OSError without a timerfd.
    """
    took_ns: list[int] = []
    inside_ns: list[int] = []
    async with (
        open_robot(fixture, folder) as robot,
        helper_process("kurt2rt.checks.bench.device", *robot.address) as device,
    ):
        await device.ask("watch")
        await device.ask("teach", lessons=_WARMING_UP)  # what is slow but once
        while len(took_ns) < lessons:
            count = min(_LESSONS_AT_ONCE, lessons - len(took_ns))
            took_ns += (await device.ask("teach", lessons=count))["took_ns"]
            for number in range(len(inside_ns), len(took_ns)):
                inside_ns.append(await _teach_inside(robot, number))
            on_progress(len(took_ns) / lessons)
    took, inside = percentiles_of(took_ns), percentiles_of(inside_ns)
    return BenchResult(
        "channel",
        "lesson answered",
        took,
        Reference("durable", inside.median_us, took.median_us),
        (BenchGoal("p99 us", took.p99_us, P99_LIMIT_US),),
        f"{lessons} lessons; durable, without the channel: p99 {inside.p99_us / 1000:.1f} ms",
    )


async def _teach_inside(robot: OpenRobot, number: int) -> int:
    """Teach like kurt2rt.checks.bench.lesson; return the time in ns."""
    command_id, gate = f"bench-inside-{number}", robot.gate
    action = tuple(robot.runtime.level.repertoire)[number % 2]
    begun_ns = time.perf_counter_ns()
    robot.runtime.inbox.put(Teach(command_id, robot.device.name, action))
    await gate.until(lambda: gate.newest is not None and bool(gate.newest.results))
    if not await to_thread.run_sync(partial(robot.writer.flush, _PATIENCE_S)):
        raise LessonLostError(robot.writer.saving_error or f"the disk did not answer within {_PATIENCE_S:g} s")
    return time.perf_counter_ns() - begun_ns
