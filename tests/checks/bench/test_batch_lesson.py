"""Benchmark of lessons in a batch."""

from kurt2rt.checks.bench.batch_lesson import TEACHERS, BatchLessonLengths, measure_batch_lessons
from kurt2rt.checks.bench.robot_under_test import BenchFixture


async def test_lessons_in_a_batch_are_compared_with_the_bus(untaught: BenchFixture) -> None:
    shares: list[float] = []
    results = await measure_batch_lessons(
        untaught, BatchLessonLengths(lesson_s=3.0, lessons=2, on_bus=1), shares.append
    )
    assert [result.bench for result in results] == ["batch"] * len(TEACHERS)
    for result in results:
        ratio, equal = result.goals
        assert result.reference is not None
        assert ratio.measured == result.reference.ratio > 0.0
        assert (equal.measured, equal.limit) == (1, 1)
    assert shares == [0.5, 1.0]
