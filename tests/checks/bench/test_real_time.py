"""Lateness and tick share: a drive of a few ticks, really in real time, and the bare loop with a clock of our own."""

from pathlib import Path

import pytest

from kurt2rt.checks.bench.real_time import RealTimeRun, RealTimeTurns, run_in_real_time, sleep_bare
from kurt2rt.checks.bench.robot_under_test import BenchFixture
from kurt2rt.checks.bench.tick_budget import TIMES_BETTER, lateness_result, tick_results
from kurt2rt.platform.ledger import Percentiles, Stage, TickTimer

NOTHING = Percentiles(0.0, 0.0, 0.0)


class LateClock:
    """Simulated time in which every wait ends so much too late."""

    def __init__(self, *late_s: float) -> None:
        self._late_s = list(late_s)
        self._now_s = 100.0
        self.deadlines_s: list[float] = []

    def now_s(self) -> float:
        return self._now_s

    async def wait_until(self, deadline_s: float) -> None:
        self.deadlines_s.append(deadline_s)
        self._now_s = deadline_s + self._late_s.pop(0)


def run(*, lateness_p99_us: float, asyncio_p99_us: float, missed: int = 0, tick: Percentiles = NOTHING) -> RealTimeRun:
    return RealTimeRun(
        ticks=6000,
        missed_ticks=missed,
        driving_share=0.97,
        rlas=91,
        lateness=Percentiles(70.0, lateness_p99_us, 2 * lateness_p99_us),
        asyncio_lateness=Percentiles(1100.0, asyncio_p99_us, 2 * asyncio_p99_us),
        tick=tick,
        stages=dict.fromkeys(Stage, NOTHING),
    )


async def test_a_drive_tells_where_its_time_went(subject: BenchFixture, tmp_path: Path) -> None:
    told: list[float] = []
    drive = await run_in_real_time(subject, tmp_path, RealTimeTurns(rounds=2, ticks=30, reference_ticks=5), told.append)
    assert told == [0.5, 1.0]
    assert drive.ticks == 60
    assert 0 <= drive.missed_ticks < 60
    assert 0.0 <= drive.driving_share <= 1.0
    assert drive.rlas >= 1
    assert list(drive.stages) == list(Stage)
    for share in (drive.tick, drive.lateness, drive.asyncio_lateness, *drive.stages.values()):
        assert 0.0 <= share.median_us <= share.p99_us <= share.worst_us
    assert max(share.worst_us for share in drive.stages.values()) <= drive.tick.worst_us


async def test_the_bare_loop_sleeps_to_multiples_of_the_period() -> None:
    clock, ledger = LateClock(0.001, 0.002, 0.003), TickTimer()
    await sleep_bare(clock, 3, 0.01, ledger)
    assert clock.deadlines_s == pytest.approx([100.01, 100.02, 100.03])
    assert ledger.lateness().median_us == pytest.approx(2000.0, rel=0.01)
    assert ledger.lateness().worst_us == pytest.approx(3000.0, rel=0.01)


async def test_the_bare_loop_skips_what_it_slept_through() -> None:
    clock = LateClock(0.025, 0.0)
    await sleep_bare(clock, 2, 0.01, TickTimer())
    assert clock.deadlines_s == pytest.approx([100.01, 100.04])


def test_a_fifth_of_the_bare_loops_lateness_will_do() -> None:
    result = lateness_result(run(lateness_p99_us=200.0, asyncio_p99_us=1000.0))
    assert result.reference is not None
    assert result.reference.ratio == pytest.approx(TIMES_BETTER)
    assert [goal.met for goal in result.goals] == [True, True]
    assert "91 RLAs" in result.note
    assert "97%" in result.note


def test_more_than_a_fifth_or_a_missed_tick_will_not() -> None:
    result = lateness_result(run(lateness_p99_us=210.0, asyncio_p99_us=1000.0, missed=1))
    assert [goal.met for goal in result.goals] == [False, False]


def test_the_ticks_goals_are_for_all_stages_together() -> None:
    *stages, whole = tick_results(
        run(lateness_p99_us=1.0, asyncio_p99_us=1.0, tick=Percentiles(90.0, 260.0, 300.0)), 0.01
    )
    assert [result.what.strip() for result in stages] == ["sense", "perceive", "decide", "guard", "learn", "publish"]
    assert not any(result.goals for result in stages)
    assert [goal.met for goal in whole.goals] == [True, False]
    assert whole.reference is not None
    assert whole.reference.ratio == pytest.approx(10_000 / 90)
