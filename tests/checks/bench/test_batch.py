"""Benchmark of exams in a batch."""

from dataclasses import replace

from kurt2rt.checks.bench.batch import BatchLengths, measure_batch
from kurt2rt.checks.bench.robot_under_test import BenchFixture
from kurt2rt.core.task_settings import load_task


async def test_batch_is_compared_with_the_bus(subject: BenchFixture) -> None:
    shares: list[float] = []
    lengths = BatchLengths(robots=4, exam_s=1.0, batches=2, on_bus=2)
    exams, runs = await measure_batch(subject, lengths, shares.append)
    ratio, equal = exams.goals
    assert exams.reference is not None
    assert runs.reference is not None
    assert ratio.measured == exams.reference.ratio > 0.0
    assert runs.goals[0].measured == runs.reference.ratio > 0.0
    assert runs.reference.took_us == exams.reference.took_us
    assert (equal.measured, equal.limit) == (2, 2)
    assert shares == [0.2, 0.4, 0.6, 0.8, 1.0]


async def test_task_whose_course_guides_robots_has_no_runs(subject: BenchFixture) -> None:
    streets = replace(subject, task=load_task("turn_left"), events=())
    (exams,) = await measure_batch(streets, BatchLengths(robots=2, exam_s=1.0, batches=1, on_bus=1), lambda _: None)
    assert exams.goals[1].measured == 1
