import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kurt2rt.experiments.paper.intervals import rate_of


def test_where_nothing_happened_the_upper_end_is_poissons() -> None:
    # The exact upper limit of a count of 0 is 3.689 (Garwood 1936).
    rate = rate_of([0, 0, 0, 0], [0.5, 0.5, 0.5, 0.5])
    assert (rate.value, rate.low) == (0.0, 0.0)
    assert rate.high == pytest.approx(3.689 / 2.0, abs=1e-3)


def test_collisions_of_one_bad_robot_are_less_sure_than_those_of_many() -> None:
    clustered = rate_of([20, *[0] * 19], [1.0] * 20)
    spread = rate_of([1] * 20, [1.0] * 20)
    assert clustered.value == spread.value == 1.0
    assert (spread.low, spread.high) == (1.0, 1.0)
    assert clustered.low == 0.0
    assert clustered.high >= 3.0


def test_one_robot_says_nothing_of_others() -> None:
    assert rate_of([3], [0.5]) == (6.0, 0.0, math.inf)


def test_the_interval_is_the_same_every_time() -> None:
    assert rate_of([3, 0, 1], [0.5, 0.4, 0.5]) == rate_of([3, 0, 1], [0.5, 0.4, 0.5])


@settings(max_examples=20)  # each draws 10 000 samples
@given(st.lists(st.tuples(st.integers(0, 9), st.floats(0.1, 2.0)), min_size=1, max_size=20))
def test_an_interval_holds_its_ends_in_order(robots: list[tuple[int, float]]) -> None:
    counts, exposures = [count for count, _ in robots], [exposure for _, exposure in robots]
    rate = rate_of(counts, exposures)
    assert rate.value == pytest.approx(sum(counts) / sum(exposures))
    assert 0.0 <= rate.low <= rate.high
