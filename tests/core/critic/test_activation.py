"""Activation of the critic in phase 5."""

import pytest

from kurt2rt.core.critic.autonomy import ActivationMonitor
from kurt2rt.core.critic.settings import ActivationSettings


def need(first_s: float = 0.0, mean_s: float = 1.0) -> ActivationMonitor:
    """Return a monitor with ticks of 10 ms."""
    return ActivationMonitor(ActivationSettings(bad_share=0.1, mean_s=mean_s, first_s=first_s), 0.01)


def drive(one: ActivationMonitor, ticks: int, bad_each: int) -> None:
    """So many ticks; of each so many the last one is bad."""
    for tick in range(1, ticks + 1):
        one.update(driving=True, bad=tick % bad_each == 0)


def test_activation_first_mean_is_unweighted() -> None:
    one = need(mean_s=1000.0)
    drive(one, 100, bad_each=20)
    assert one.share == pytest.approx(0.05, rel=0.01)
    assert not one.needed


def test_activation_bad_share_activates_for_good() -> None:
    one = need()
    drive(one, 500, bad_each=5)
    assert one.needed
    drive(one, 5000, bad_each=10_000)
    assert one.share < 0.01
    assert one.needed
    one.reset()
    assert (one.needed, one.share) == (False, 0.0)


def test_activation_not_before_first_s() -> None:
    one = need(first_s=1.0)
    drive(one, 99, bad_each=2)
    assert not one.needed
    one.update(driving=True, bad=True)
    assert one.needed


def test_activation_standstill_does_not_count() -> None:
    one = need()
    for _ in range(1000):
        one.update(driving=False, bad=True)
    assert (one.needed, one.share) == (False, 0.0)
