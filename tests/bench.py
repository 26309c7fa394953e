"""Benchmarks of the runtime on this machine, with the simulated robot: `python -m tests.bench`, or `make bench`.

It takes some 7 minutes, with `--quick` one. Each row has a reference of the same run: `times` says how many times as
long the reference took, which depends less on the machine than a time does. The goals are meant for an idle machine; a
benchmark informs, and fails by none of them.
"""

import argparse
import asyncio
import itertools
import json
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import NamedTuple

import anyio
import numpy as np
from anyio import to_thread

from hal.bus import open_bus
from hal.kurt2 import Kurt2
from hal.kurt2_settings import load_kurt2
from kurt2rt.channel.security.pairing import local_pairing
from kurt2rt.channel.server.channel import Channel
from kurt2rt.checks.doctor.checks import fsync_ns
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.matching import ConditionIndex, exact_distances
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by_named
from kurt2rt.core.teaching.commands import Command, SetPhase, Take, Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.batch_exam import examine_in_batch
from kurt2rt.experiments.lockstep.batch_lesson import teach_in_batch
from kurt2rt.experiments.lockstep.exam import ExamSetup, examine
from kurt2rt.experiments.lockstep.lesson import GivenLesson, teach
from kurt2rt.experiments.lockstep.runtimes import TrainingStore
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.loading import open_knowledge
from kurt2rt.knowledge.journal.writer import utc_now
from kurt2rt.platform.scheduler import Scheduler
from kurt2rt.platform.tick_timer import Percentiles, TickTimer, percentiles_of
from kurt2rt.platform.timerfd_clock import TimerfdClock
from kurt2rt.runs.recording.recording import Recording
from kurt2rt.runs.recording.run_folder import budget_of
from kurt2rt.service.assembly import RunSettings
from kurt2rt.service.post_tick import ProgramConsole
from kurt2rt.service.serve import ChannelOptions, ServeOptions, serve
from kurt2rt.service.settings import load_service
from kurt2rt.teacher.client.client import TeacherClient
from simbridge.simulation import Kurt2SimulationFactory

SEED = 1
ROBOT = load_kurt2()
FACTORY = Kurt2SimulationFactory(ROBOT)
PERIOD_S = ROBOT.cycle_s
PERIOD_US = PERIOD_S * 1e6
_WARM_UP_TICKS = 100
_PRESS_M_S = 0.05


class AsyncioClock:
    """Waits by `asyncio.sleep`, as the reference for better clocks."""

    def now_s(self) -> float:
        """Return the monotonic time in s."""
        return time.monotonic()

    async def wait_until(self, deadline_s: float) -> None:
        """Return at the deadline, rounded up to the event loop's whole milliseconds."""
        await asyncio.sleep(deadline_s - time.monotonic())


def ignore(_: object) -> None:
    """Do nothing."""


class Row(NamedTuple):
    """Row of the table."""

    measured: str
    took: Percentiles
    reference: str
    reference_us: float
    goals: Mapping[str, bool]
    """Goals, and whether they are met."""
    compares_p99: bool = False
    """True if the reference is compared with p99, not with the median."""


@dataclass(frozen=True, slots=True)
class Bench:
    """Taught robot, a folder on the disk to measure, and the share of a full run that is measured."""

    events: Sequence[TeachingEvent]
    folder: Path
    share: float

    def count(self, full: int) -> int:
        return max(2, round(full * self.share))

    def run_settings(self, name: str) -> RunSettings:
        """Return settings of a service with knowledge and pairing of its own, in a new folder."""
        folder = self.folder / name
        local_pairing(folder / "teachers", folder / "devices")
        with open_knowledge(folder / "bench.knowledge", ROBOT, TASK) as journal:
            journal.append([JournalEntry(event, utc_now()) for event in self.events])
        paths = {"knowledge": str(folder / "bench.knowledge"), "teachers": str(folder / "teachers"), "port": 0}
        return RunSettings(ROBOT, TASK, load_service().model_copy(update=paths))


def wall_following(lesson_s: float = 345.0, exam_s: float = 60.0) -> TaskSettings:
    """Return the task with a lesson and an exam of this length; two thirds of the lesson are with corrections."""
    spans = {
        "teaching.supervised_s": lesson_s / 3,
        "teaching.corrections_s": lesson_s * 2 / 3,
        "exam.duration_s": exam_s,
    }
    return load_task("wall_following", changes={name: f"{span_s:.2f}" for name, span_s in spans.items()})


TASK = wall_following()


async def taught_on_bus(
    task: TaskSettings, seed: int, events: Sequence[TeachingEvent] = (), on_second: Callable[[float], None] = ignore
) -> GivenLesson:
    """Give a lesson in lockstep over the CAN bus, to a robot that knows `events`."""
    store = InMemoryEventStore()
    with closing(FACTORY.open(task.teaching.world, seed, "lesson")) as simulation:
        training = TrainingStore(store, events)
        result = await teach(simulation, ROBOT, task, training, seed=seed, on_progress=on_second)
    return GivenLesson(result, store.events)


QUIET = ProgramConsole(status=ignore, question=ignore, acknowledged=ignore)


async def program(bench: Bench) -> list[Row]:
    """Run the whole program in real time, its robot in another process, in turns with loops that do nothing."""
    settings, bus, ticks = bench.run_settings("program"), f"shared:bench-{os.getpid()}", bench.count(500)
    recording = Recording(bench.folder / "runs", budget_of(1000), "bench")
    used_ns, empty_ns, at_ns, missed, bare = [], [], list[int](), 0, TickTimer()
    shares, late = list[Percentiles](), list[Percentiles]()

    def on_tick(record: TickRecord) -> Command | None:
        if record.number >= _WARM_UP_TICKS:
            at_ns[1:] = [time.process_time_ns()]
        return SetPhase("bench-phase", "bench", Phase.AUTONOMOUS) if record.number == 1 else None

    duration_s = (_WARM_UP_TICKS + ticks) * PERIOD_S
    options = ServeOptions(on_tick=on_tick, channel=ChannelOptions(), duration_s=duration_s, recording=recording)
    words = ("sim", "--bus", bus, "--world", TASK.teaching.world, "--seed", str(SEED), "--while-stdin")
    with closing(Kurt2(ROBOT, open_bus(bus))) as robot, started("kurt2rt.cli.main", *words), TimerfdClock() as clock:
        for _ in range(bench.count(12)):
            at_ns.clear()
            robot.release()
            with robot.watchdog:
                last = await serve(robot, settings, QUIET, options)
            assert last is not None
            timer = last.runtime.timer
            used_ns.append((at_ns[-1] - at_ns[0]) // (timer.ticks - _WARM_UP_TICKS))
            late.append(timer.lateness_of_last(ticks))
            missed += timer.missed_ticks
            shares.append(timer.tick())
            for each, empty in ((clock, TickTimer()), (AsyncioClock(), bare)):
                begun_ns = time.process_time_ns()
                await Scheduler(each, lambda *_: None, PERIOD_S, empty).run(ticks, ignore)
                empty_ns.append((time.process_time_ns() - begun_ns) // ticks)
    used, empty_us, sleep_us = percentiles_of(used_ns), percentiles_of(empty_ns[::2]).median_us, bare.lateness().p99_us
    usual, tick = (Percentiles(*np.median([astuple(each) for each in rounds], axis=0)) for rounds in (late, shares))
    on_time = {"5 times": sleep_us >= 5.0 * usual.p99_us, "0 missed": missed == 0}
    goals = {"5 % of a core": used.median_us <= PERIOD_US * 0.05}
    return [
        Row("tick begins late", usual, "asyncio.sleep, p99", sleep_us, on_time, compares_p99=True),
        share_of_tick("tick, real time", tick),
        Row("processor time of a tick", used, "empty loop", empty_us, goals),
    ]


def share_of_tick(measured: str, tick: Percentiles) -> Row:
    goals = {"median 100 µs": tick.median_us <= 100.0, "p99 250 µs": tick.p99_us <= 250.0}
    return Row(measured, tick, "period", PERIOD_US, goals)


def started(module: str, *words: str) -> subprocess.Popen[bytes]:
    """Run a Python module that ends with its input, in a session of its own, so that Ctrl-C comes here first."""
    command = [sys.executable, "-m", module, *words]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True)


async def match(bench: Bench) -> list[Row]:
    """Seek the nearest RLA, in turns with a brute force, which must find the same one."""
    rows, chance = [], np.random.default_rng(SEED)
    for rlas, goal_us, calls in ((135, 10.0, 5000), (1_000, 15.0, 5000), (100_000, 1500.0, 400)):
        conditions = chance.uniform(0.0, 600.0, (rlas, 72))
        index, took_ns, brute_ns = ConditionIndex(72), [], []
        for condition in conditions:
            index.insert(len(index), tuple(condition.tolist()))
        for call in range(bench.count(calls)):
            # Near some condition, as the situations of a robot that knows its way are.
            situation = conditions[chance.integers(rlas)] + chance.normal(0.0, 20.0, 72)
            begun_ns = time.perf_counter_ns()
            nearest = index.nearest(situation)
            took_ns.append(time.perf_counter_ns() - begun_ns)
            if call % 10 == 0:
                begun_ns = time.perf_counter_ns()
                winner = int(exact_distances(conditions, situation).argmin())
                brute_ns.append(time.perf_counter_ns() - begun_ns)
                assert nearest is not None
                assert nearest.position == winner
        took, brute_us = percentiles_of(took_ns), percentiles_of(brute_ns).median_us
        goals = {f"median {goal_us:.0f} µs": took.median_us <= goal_us}
        rows.append(Row(f"nearest of {rlas} RLAs", took, "brute force", brute_us, goals))
    return rows


@contextmanager
def on_one_core() -> Iterator[None]:
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})  # interrupts mostly come to the first one
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


async def loop(bench: Bench) -> list[Row]:
    """Go on with a lesson in lockstep on one core: world, codec, bus, runtime and teacher."""
    at_ns: list[int] = []
    with on_one_core():
        task = wall_following(bench.count(300))
        given = await taught_on_bus(task, SEED, bench.events, lambda _: at_ns.append(time.perf_counter_ns()))
    tick = percentiles_of([round((end - begin) * PERIOD_S) for begin, end in itertools.pairwise(at_ns)])
    goals = {"60 times": 60.0 * tick.median_us <= PERIOD_US}
    return [
        Row("closed loop in lockstep, a tick", tick, "period", PERIOD_US, goals),
        share_of_tick("runtime's share of a tick, lockstep", given.result.timer.tick()),
    ]


async def channel(bench: Bench) -> list[Row]:
    """Press and teach over UDP, from a teacher's device in a process of its own."""
    settings, presses = bench.run_settings("channel"), bench.count(200)
    device = str(bench.folder / "channel" / "devices" / "local")
    told, speeds = list[bytes](), list[tuple[int, float]]()

    def on_tick(record: TickRecord) -> None:
        speeds.append((time.monotonic_ns(), record.guard_result.wheel_speeds.left_m_s))

    def on_open(channel: Channel) -> None:
        tasks.start_soon(press, channel.endpoint.port)

    async def press(port: int) -> None:
        with started("tests.bench", "--device", device, str(port), str(presses)) as process:
            told.append((await to_thread.run_sync(process.communicate))[0])
        tasks.cancel_scope.cancel()

    with closing(FACTORY.open(TASK.teaching.world, SEED, "channel")) as simulation, simulation.live():
        async with anyio.create_task_group() as tasks:
            options = ServeOptions(on_tick=on_tick, channel=ChannelOptions(on_open=on_open), stopped=True)
            await serve(simulation.robot, settings, QUIET, options)
    made, lessons_ns, syncs_ns = json.loads(told[0])
    waits_ns: list[int] = []
    for (at_ns, pressed), (until_ns, _) in itertools.pairwise((*made, (time.monotonic_ns(), 0.0))):
        moved_ns = (tick_ns for tick_ns, speed in speeds if at_ns <= tick_ns < until_ns and speed * pressed > 0.0)
        waits_ns += [tick_ns - at_ns for tick_ns in itertools.islice(moved_ns, 1)]
    took, lesson, sync_us = percentiles_of(waits_ns), percentiles_of(lessons_ns), percentiles_of(syncs_ns).median_us
    lost = presses - len(waits_ns)
    goals = {"median 25 ms": took.median_us <= 25e3, "p99 60 ms": took.p99_us <= 60e3, "0 lost": lost == 0}
    durable = {"p99 35 ms": lesson.p99_us <= 35e3}
    return [
        Row("press on a device, to CONTROL", took, "period", PERIOD_US, goals),
        Row("lesson of a device, durable", lesson, "bare fsync", sync_us, durable),
    ]


async def be_the_device(folder: Path, port: int, presses: int) -> None:
    """Press forward and back, and teach, as often; print times of presses, and durations of lessons and of fsync."""
    made, lessons_ns, syncs_ns, chance = [], [], [], random.Random(SEED)
    async with TeacherClient(folder, port=port) as robot:
        robot.watching = True
        assert (await robot.send(Take)).accepted
        await anext(aiter(robot.states()))
        with (folder / "sync").open("wb", buffering=0) as file:
            for number in range(presses):
                speed_m_s = _PRESS_M_S if number % 2 == 0 else -_PRESS_M_S
                made.append((time.monotonic_ns(), speed_m_s))
                robot.press(speed_m_s, speed_m_s)
                await anyio.sleep(chance.uniform(0.10, 0.15))
                await robot.let_go()
                await anyio.sleep(chance.uniform(0.15, 0.25))  # the teacher does not know when ticks begin
                begun_ns = time.perf_counter_ns()
                assert (await robot.send(Teach, action="forward" if number % 2 == 0 else "back")).accepted
                lessons_ns.append(time.perf_counter_ns() - begun_ns)
                syncs_ns.append(fsync_ns(file))
    print(json.dumps((made, lessons_ns, syncs_ns)))


async def batch(bench: Bench) -> list[Row]:
    """Drive exams and runs of a certificate, and give lessons, in compiled loops, and some of them on the CAN bus."""
    task = wall_following(bench.count(345), bench.count(60))
    worlds, seeds = task.exam.worlds, range(bench.count(30))
    setups = [
        ExamSetup(worlds[seed % len(worlds)], seed, teacher_policy=seed % 2 == 1, events=bench.events) for seed in seeds
    ]
    runs = [ExamSetup(setup.world, setup.seed, events=bench.events) for setup in setups]
    exam_ns, run_ns, bus_ns = [], [], []
    with on_one_core():
        for _ in range(1 + bench.count(5)):  # the first one compiles, or loads what is compiled
            begun_ns = time.perf_counter_ns()
            finished = examine_in_batch(FACTORY, ROBOT, task, setups)
            exam_ns.append(per_tick(begun_ns, sum(each.duration_s for each in finished if each is not None)))
            begun_ns = time.perf_counter_ns()
            driven = examine_in_batch(FACTORY, ROBOT, task, runs, measured=False)
            run_ns.append(per_tick(begun_ns, sum(each.duration_s for each in driven if each is not None)))
        for setup, result in itertools.islice(zip(setups, finished, strict=True), bench.count(6)):
            begun_ns = time.perf_counter_ns()
            with closing(FACTORY.open(setup.world, setup.seed, "exam")) as simulation:
                on_bus = await examine(simulation, ROBOT, task, setup, ignore)
            bus_ns.append(per_tick(begun_ns, on_bus.duration_s))
            assert result in (on_bus, None)
        rows = [
            against_bus("exam in a batch, a tick", exam_ns[1:], bus_ns, 20.0),
            against_bus("run of certify in a batch, a tick", run_ns[1:], bus_ns, 60.0),
        ]
        for teacher in ("superhuman", "ordinary"):
            measured = f"lesson by {teacher} in a batch, a tick"
            rows.append(await _lessons_in_batch(bench, taught_by_named(task, teacher), measured))
    return rows


async def _lessons_in_batch(bench: Bench, task: TaskSettings, measured: str) -> Row:
    given, batch_ns, bus_ns = list[GivenLesson | None](), [], []
    lesson_s = task.teaching.supervised_s + task.teaching.corrections_s
    for seed in range(1 + bench.count(6)):  # the first one compiles, too
        begun_ns = time.perf_counter_ns()
        given.append(teach_in_batch(FACTORY, ROBOT, task, seed=seed, on_progress=ignore))
        batch_ns.append(per_tick(begun_ns, lesson_s))
    for seed, in_batch in itertools.islice(enumerate(given), 2):
        begun_ns = time.perf_counter_ns()
        on_bus = await taught_on_bus(task, seed)
        bus_ns.append(per_tick(begun_ns, lesson_s))
        if in_batch is not None:
            assert list(in_batch.events) == list(on_bus.events)
    return against_bus(measured, batch_ns[1:], bus_ns, 10.0)


def per_tick(begun_ns: int, robot_s: float) -> int:
    """Return the ns of a robot's tick since `begun_ns`, in which robots drove for so many seconds together."""
    return round((time.perf_counter_ns() - begun_ns) * PERIOD_S / robot_s)


def against_bus(measured: str, took_ns: list[int], bus_ns: list[int], goal: float) -> Row:
    took, bus_us = percentiles_of(took_ns), percentiles_of(bus_ns).median_us
    return Row(measured, took, "CAN bus", bus_us, {f"{goal:.0f} times": bus_us >= goal * took.median_us})


BENCHES = {each.__name__: each for each in (program, match, loop, channel, batch)}


async def measure(names: Sequence[str], folder: Path, share: float) -> list[Row]:
    """Teach a robot in lockstep, and measure with it, in a folder on the disk."""
    given = await taught_on_bus(wall_following(max(20.0, 345.0 * share)), SEED)
    return [row for name in names for row in await BENCHES[name](Bench(given.events, folder, share))]


def as_table(rows: Sequence[Row]) -> Iterator[str]:
    """Yield the lines of a Markdown table, one for each measurement."""
    yield "| measured | median | p99 | reference in the same run | times | goal: met |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for row in rows:
        goals = ", ".join(f"{goal}: {'yes' if met else '**no**'}" for goal, met in row.goals.items())
        times = row.reference_us / max(row.took.p99_us if row.compares_p99 else row.took.median_us, 1e-3)
        took = f"{row.took.median_us:.1f} µs | {row.took.p99_us:.1f} µs"
        yield f"| {row.measured} | {took} | {row.reference} {row.reference_us:.0f} µs | {times:.2f} | {goals} |"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.bench", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(BENCHES)}; all if none is given")
    parser.add_argument("--quick", action="store_true", help="a tenth of it; rare lateness may hide")
    parser.add_argument("--device", nargs=3, help=argparse.SUPPRESS)
    words = parser.parse_args()
    if words.device:
        folder, port, presses = words.device
        anyio.run(be_the_device, Path(folder), int(port), int(presses))
        return
    with tempfile.TemporaryDirectory(prefix=".bench-", dir=".") as folder:
        rows = anyio.run(measure, words.names or list(BENCHES), Path(folder), 0.1 if words.quick else 1.0)
    print(*as_table(rows), sep="\n")
    print(f"\n{len(os.sched_getaffinity(0))} cores, load {', '.join(f'{load:.1f}' for load in os.getloadavg())}.")


if __name__ == "__main__":
    main()
