"""Last bits that depend on the processor are rounded away."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as some

from kurt2rt.core.numerics import power, round_portable


@given(some.floats(-1000, 1000))
def test_it_is_rounded_by_less_than_anybody_would_notice(value: float) -> None:
    assert round_portable(value) == pytest.approx(value, abs=2e-10)
    assert round_portable(round_portable(value)) == round_portable(value)


def test_neighbours_become_one_number() -> None:
    for place in range(2000):
        cosine = math.cos(0.0137 * place)
        assert (
            round_portable(math.nextafter(cosine, 2.0))
            == round_portable(cosine)
            == round_portable(math.nextafter(cosine, -2.0))
        )


@given(some.floats(0.5, 1.5), some.integers(-300, 300))
def test_a_power_is_a_power(base: float, exponent: int) -> None:
    assert power(base, exponent) == pytest.approx(base**exponent, rel=1e-12)
