"""Limits of a person: drawn delays and lapses of attention."""

import statistics
from itertools import groupby

from kurt2rt.core.teacher_settings import LapseSettings, LogNormalDelay
from kurt2rt.teacher.scripted.human_limits import AttentionLapses, DelaySampler

DELAY = LogNormalDelay(kind="log_normal", median_s=1.25, spread=0.42, longest_s=4.0)


def drawn(seed: str, now: int = 0, slower_per_minute: float = 0.0) -> list[int]:
    sampler = DelaySampler(DELAY, slower_per_minute, 0.01, seed)
    return [sampler.draw(now) for _ in range(1000)]


def test_draw_median_is_that_of_the_settings() -> None:
    assert 118 < statistics.median(drawn("x")) < 132


def test_is_on_lapses_have_the_set_rate_and_duration() -> None:
    duration = LogNormalDelay(kind="log_normal", median_s=2.0, spread=0.0, longest_s=9.0)
    attention = AttentionLapses(LapseSettings(per_minute=2.0, duration=duration), 0.01, "x")
    looks = [attention.is_on(tick) for tick in range(6000 * 60)]
    lapses = [len(list(ticks)) for on, ticks in groupby(looks) if not on]
    assert set(lapses[:-1]) == {200}
    assert 80 < len(lapses) < 150
