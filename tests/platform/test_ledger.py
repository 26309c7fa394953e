"""The ledger of time; only sums and bounds are checked, for the durations in it are real."""

import pytest

from kurt2rt.platform.ledger import Percentiles, Stage, TickTimer


def tick(ledger: TickTimer, lateness_s: float) -> None:
    ledger.begin(lateness_s)
    for stage in Stage:
        ledger.lap(stage)
    ledger.end()


def test_before_the_first_tick_all_shares_are_zero() -> None:
    ledger = TickTimer()
    assert ledger.tick() == ledger.lateness() == ledger.stage(Stage.DECIDE) == Percentiles(0.0, 0.0, 0.0)


def test_shares_are_median_99th_percentile_and_worst() -> None:
    ledger = TickTimer()
    for microseconds in range(1, 101):
        tick(ledger, microseconds * 1e-6)
    share = ledger.lateness()
    assert (share.median_us, share.p99_us, share.worst_us) == pytest.approx((50.5, 99.01, 100.0), abs=0.01)


def test_the_stages_make_up_the_tick() -> None:
    ledger = TickTimer()
    tick(ledger, 0.0)
    assert ledger.tick().worst_us == pytest.approx(sum(ledger.stage(stage).worst_us for stage in Stage))
    assert all(ledger.stage(stage).worst_us >= 0 for stage in Stage)


def test_only_the_last_ticks_are_kept() -> None:
    ledger = TickTimer(capacity=10)
    tick(ledger, 1.0)
    for _ in range(9):
        tick(ledger, 0.001)
    assert ledger.lateness().worst_us == pytest.approx(1e6)
    tick(ledger, 0.002)
    assert ledger.lateness().worst_us == pytest.approx(2e3)
    assert ledger.ticks == 11


def test_times_of_the_last_ticks_come_oldest_first(monkeypatch: pytest.MonkeyPatch) -> None:
    now_ns = 0
    monkeypatch.setattr("kurt2rt.platform.ledger.time.perf_counter_ns", lambda: now_ns)
    ledger = TickTimer(capacity=3)
    for took_ns in (10, 20, 30, 40):
        ledger.begin(0.0)
        now_ns += took_ns
        ledger.lap(Stage.SENSE)
        now_ns += 1
        ledger.lap(Stage.PUBLISH)
        ledger.end()
    assert ledger.ticks_ns().tolist() == [21, 31, 41]
