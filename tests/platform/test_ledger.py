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
