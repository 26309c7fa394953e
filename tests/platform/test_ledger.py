"""The ledger of time; only sums and bounds are checked, for the durations in it are real."""

import pytest

from kurt2rt.platform.ledger import Stage, TickTimer


def tick(ledger: TickTimer, lateness_s: float) -> None:
    ledger.begin(lateness_s)
    for stage in Stage:
        ledger.lap(stage)
    ledger.end()


def test_shares_are_median_99th_percentile_and_worst() -> None:
    ledger = TickTimer()
    for microseconds in range(1, 101):
        tick(ledger, microseconds * 1e-6)
    share = ledger.lateness()
    assert (share.median_us, share.p99_us, share.worst_us) == pytest.approx((50.5, 99.01, 100.0), abs=0.01)


def test_the_stages_make_up_the_tick(monkeypatch: pytest.MonkeyPatch) -> None:
    now_ns = 0
    monkeypatch.setattr("kurt2rt.platform.ledger.time.perf_counter_ns", lambda: now_ns)
    ledger = TickTimer()
    ledger.begin(0.0)
    for stage in Stage:
        now_ns += 1000
        ledger.lap(stage)
    ledger.end()
    assert ledger.tick().worst_us == len(Stage)
