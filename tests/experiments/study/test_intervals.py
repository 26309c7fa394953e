import statistics

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.experiments.study.intervals import fall_of, poisson_interval, quartiles, rate_of, wilson_interval


def test_rate_of_clustered_events_has_a_wider_interval() -> None:
    clustered = rate_of([20, *[0] * 19], [1.0] * 20)
    spread = rate_of([1] * 20, [1.0] * 20)
    assert clustered.value == spread.value == 1.0
    # Those are all alike, and Poisson's interval of 20 is left; this one is drawn three times or not at all.
    assert (spread.low, spread.high) == pytest.approx((12.217 / 20, 30.888 / 20), abs=1e-4)
    assert clustered.low == 0.0
    assert clustered.high >= 3.0


@pytest.mark.parametrize(
    ("events", "low", "high"),
    [(0, 0.0, 3.6889), (1, 0.0253, 5.5716), (2, 0.2422, 7.2247), (10, 4.7954, 18.3904), (100, 81.3637, 121.6273)],
)
def test_poissons_interval_is_garwoods(events: int, low: float, high: float) -> None:
    # As chi-square tables have it.
    assert poisson_interval(events) == pytest.approx((low, high), abs=1e-3)


def test_a_fall_is_told_with_an_interval_over_pairs() -> None:
    certain = fall_of([2.0, 4.0, 6.0] * 7, [1.0, 2.0, 3.0] * 7)
    assert certain == pytest.approx((0.5, 0.5, 0.5))  # robots differ, the fall is the same in all
    unsure = fall_of([4.0] * 20, [8.0, 0.0] * 10)
    assert unsure.value == 0.0
    assert -0.6 < unsure.low < -0.2 < 0.2 < unsure.high < 0.6
    assert fall_of([0.0, 0.0], [0.0, 0.0]) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("successes", "trials", "low", "high"),
    [  # as published: Newcombe 1998, table I, method 3, and R's prop.test(correct = FALSE)
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 1, 0.2065, 1.0),
    ],
)
def test_the_interval_of_a_share_is_wilsons(successes: int, trials: int, low: float, high: float) -> None:
    assert wilson_interval(successes, trials) == pytest.approx((low, high), abs=6e-5)


@given(st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=50))
def test_quartiles_are_those_of_the_standard_library(values: list[float]) -> None:
    assert quartiles(values) == pytest.approx(statistics.quantiles(values, n=4, method="inclusive"), abs=1e-6)
