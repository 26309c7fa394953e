"""All benchmarks in one run, tiny."""

from pathlib import Path
from unittest.mock import AsyncMock

import pytest

from kurt2rt.checks.bench import suite
from kurt2rt.checks.bench.batch import BatchLengths
from kurt2rt.checks.bench.batch_lesson import BatchLessonLengths
from kurt2rt.checks.bench.channel import ChannelLengths
from kurt2rt.checks.bench.channel_load import LoadShifts
from kurt2rt.checks.bench.match import Size
from kurt2rt.checks.bench.program import ProgramTurns
from kurt2rt.checks.bench.real_time import RealTimeTurns
from kurt2rt.checks.bench.robot_under_test import BenchFixture, OnProgress
from kurt2rt.checks.bench.suite import FULL, QUICK, BenchName, Lengths, run_suite
from kurt2rt.experiments.lockstep.lesson_keeping import LessonLostError
from tests.checks.bench.test_report import RESULTS

TINY = Lengths(
    learning_s=3.0,
    turns=RealTimeTurns(rounds=1, ticks=20, reference_ticks=2),
    program=ProgramTurns(rounds=1, ticks=20, empty_ticks=5),
    sizes=(Size(20, 10.0, 20),),
    loop_blocks=1,
    loop_block_s=1,
    lessons=2,
    channel=ChannelLengths(presses=1, shifts=LoadShifts(rounds=1, ticks=10), lessons=1),
    batch=BatchLengths(robots=2, exam_s=1.0, batches=1, on_bus=2),
    batch_lessons=BatchLessonLengths(lesson_s=3.0, lessons=1, on_bus=1),
    recording=LoadShifts(rounds=1, ticks=20),
)


class Jobs:
    """The names of the jobs that were begun."""

    def __init__(self) -> None:
        self.names: list[str] = []

    def __call__(self, what: str) -> OnProgress:
        self.names.append(what)
        return lambda _: None


@pytest.mark.deep
async def test_run_suite_measures_all_in_order_with_one_drive(untaught: BenchFixture, tmp_path: Path) -> None:
    jobs = Jobs()
    benches = [
        bench for bench in BenchName if bench is not BenchName.CHANNEL
    ]  # its processes take seconds: test_channel.py
    results, errors = await run_suite(benches, untaught, tmp_path, TINY, jobs)
    assert list(dict.fromkeys(result.bench for result in results)) == [bench.value for bench in benches]
    assert errors == ()
    assert len(jobs.names) == 9
    assert all(result.goals for result in results if not result.what.startswith("  "))


@pytest.mark.parametrize(
    ("chosen", "jobs_begun"),
    [
        (BenchName.MATCH, ["matching"]),
        (BenchName.TICK, ["teaching, to have something to drive with", "driving in real time"]),
    ],
)
async def test_only_what_is_asked_for_is_measured(
    chosen: BenchName, jobs_begun: list[str], untaught: BenchFixture, tmp_path: Path
) -> None:
    jobs = Jobs()
    results, errors = await run_suite({chosen}, untaught, tmp_path, TINY, jobs)
    assert {result.bench for result in results} == {chosen}
    assert errors == ()
    assert jobs.names == jobs_begun


async def test_run_suite_failed_benchmark_leaves_the_others(
    untaught: BenchFixture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lost = LessonLostError("the disk did not answer")
    monkeypatch.setattr(suite, "measure_lessons", AsyncMock(side_effect=lost))
    monkeypatch.setattr(suite, "measure_batch", AsyncMock(return_value=RESULTS[:1]))
    monkeypatch.setattr(suite, "measure_batch_lessons", AsyncMock(return_value=RESULTS[1:2]))
    chosen = {BenchName.MATCH, BenchName.LESSON, BenchName.BATCH}
    results, errors = await run_suite(chosen, untaught, tmp_path, TINY, Jobs())
    assert results[0].bench == "match"
    assert results[1:] == RESULTS[:2]
    assert errors == (lost,)
    assert lost.__notes__ == ["bench lesson"]


def test_a_full_run_drives_a_minute_and_a_quick_one_five_seconds() -> None:
    assert FULL.turns.rounds * FULL.turns.ticks == 6000
    assert QUICK.turns.rounds * QUICK.turns.ticks == 500
    assert FULL.loop_block_s == QUICK.loop_block_s == 20
