"""Benchmark of lessons in a batch, with the same lessons on the CAN bus as reference."""

import time
from contextlib import closing
from dataclasses import dataclass

from hal.batch_lesson import LessonFactory
from kurt2rt.checks.bench.closed_loop import on_one_core
from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference
from kurt2rt.checks.bench.robot_under_test import BenchFixture, OnProgress, with_duration
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.task_settings import TaskSettings, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep.batch_lesson import teach_in_batch
from kurt2rt.experiments.lockstep.drive_loop import BatchDiffersError
from kurt2rt.experiments.lockstep.given_lesson import GivenLesson, require_equal_lessons
from kurt2rt.experiments.lockstep.lesson import teach
from kurt2rt.experiments.lockstep.runtimes import TrainingStore
from kurt2rt.platform.ledger import percentiles_of

TEACHERS = ("superhuman", "ordinary")
TIMES_THE_BUS = 10.0


@dataclass(frozen=True, slots=True)
class BatchLessonLengths:
    """Amount of measurement of lessons in a batch, for each teacher."""

    lesson_s: float
    lessons: int
    on_bus: int
    """Lessons of these that the bus gives as well."""


async def measure_batch_lessons(
    fixture: BenchFixture, lengths: BatchLessonLengths, on_progress: OnProgress
) -> list[BenchResult]:
    """Return the time of a tick of a lesson in a batch for each teacher, on one core.

    Raises BatchRefusedError for a task that a batch does not know.
    """
    results = []
    for done, teacher in enumerate(TEACHERS):
        supervised_s = lengths.lesson_s / 3
        task = with_duration(
            taught_by(fixture.task, load_teacher(teacher)),
            supervised_s=supervised_s,
            corrections_s=lengths.lesson_s - supervised_s,
        )
        results.append(await _measure_teacher(fixture, task, lengths))
        on_progress((done + 1) / len(TEACHERS))
    return results


async def _measure_teacher(fixture: BenchFixture, task: TaskSettings, lengths: BatchLessonLengths) -> BenchResult:
    ticks = lengths.lesson_s / fixture.settings.cycle_s
    in_batch: list[GivenLesson | None] = []
    batch_ns, bus_ns, equal, compared = [], [], 0, 0
    with on_one_core() as core:
        _teach(fixture, task, lengths.lessons)  # compiles, or loads what is compiled
        for seed in range(lengths.lessons):
            begun_ns = time.perf_counter_ns()
            in_batch.append(_teach(fixture, task, seed))
            batch_ns.append(round((time.perf_counter_ns() - begun_ns) / ticks))
        for seed, given in enumerate(in_batch[: lengths.on_bus]):
            begun_ns = time.perf_counter_ns()
            on_bus = await _teach_on_bus(fixture, task, seed)
            bus_ns.append(round((time.perf_counter_ns() - begun_ns) / ticks))
            if given is not None:
                compared += 1
                equal += _are_equal(given, on_bus)
    tick = percentiles_of(batch_ns)
    reference = Reference("on the bus", percentiles_of(bus_ns).median_us, tick.median_us)
    return BenchResult(
        "batch",
        f"lesson by {task.teaching.profile.name} in a batch, a tick",
        tick,
        reference,
        (
            BenchGoal("ratio", reference.ratio, TIMES_THE_BUS, at_least=True),
            BenchGoal("equal", equal, compared, at_least=True),
        ),
        f"{lengths.lessons} lessons of {lengths.lesson_s:g} s on core {core}: {1e6 / tick.median_us:,.0f} robot ticks "
        f"a second; {equal} of {compared} lessons equal to the bus, {in_batch.count(None)} left the batch",
    )


def _teach(fixture: BenchFixture, task: TaskSettings, seed: int) -> GivenLesson | None:
    factory = fixture.batches
    assert isinstance(factory, LessonFactory), "the fixture names no batch"
    return teach_in_batch(factory, fixture.settings, task, seed=seed, on_progress=lambda _: None)


async def _teach_on_bus(fixture: BenchFixture, task: TaskSettings, seed: int) -> GivenLesson:
    factory, store = fixture.batches, InMemoryEventStore()
    assert factory is not None
    with closing(factory.open(task.teaching.world, seed, "lesson")) as simulation:
        result = await teach(
            simulation, fixture.settings, task, TrainingStore(store), seed=seed, on_progress=lambda _: None
        )
    return GivenLesson(result, store.events)


def _are_equal(batch: GivenLesson, bus: GivenLesson) -> bool:
    try:
        require_equal_lessons(batch, bus)
    except BatchDiffersError:
        return False
    return True
