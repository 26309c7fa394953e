"""Which features made a distance, and which speak for one RLA against another."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.runs.explain.attribution import border_distance, contrast_attribution, distance_attribution
from tests.runs.explain.helpers import level, story

HERE = (10.0, 20.0, 30.0)
MINE = story(1, (13.0, 16.0, 30.0), "forward", 5.0)
OTHER = story(2, (10.0, 30.0, 30.0), "back", 10.0)


def test_attribution_at_the_taught_situation_is_empty() -> None:
    assert distance_attribution(level(HERE, story(1, HERE, "forward", 0.0)), story(1, HERE, "forward", 0.0)) == ()


def test_of_two_equal_ones_nothing_speaks_for_either() -> None:
    assert contrast_attribution(level(HERE, MINE, MINE), MINE, MINE) == {}
    assert border_distance(level(HERE, MINE, MINE), MINE, MINE) is None


def test_symbols_have_no_border() -> None:
    assert border_distance(replace(level(HERE, MINE, OTHER), euclidean=False), MINE, OTHER) is None


_NUMBERS = st.floats(-500, 500)


@given(st.tuples(_NUMBERS, _NUMBERS), st.tuples(_NUMBERS, _NUMBERS), st.tuples(_NUMBERS, _NUMBERS))
def test_at_the_border_both_are_equally_near(
    here: tuple[float, float], one: tuple[float, float], other: tuple[float, float]
) -> None:
    apart = math.dist(one, other)
    if apart < 1.0:
        return
    first, second = story(1, one, "forward", math.dist(here, one)), story(2, other, "back", math.dist(here, other))
    border = border_distance(level(here, first, second), first, second)
    assert border is not None
    there = tuple(x + border * (y - z) / apart for x, y, z in zip(here, other, one, strict=True))
    assert math.dist(there, one) == pytest.approx(math.dist(there, other), abs=1e-6)


def test_contrast_of_the_nearest_is_the_next_with_another_action() -> None:
    nearest, same, other = story(1, (1.0,), "back", 1), story(2, (2.0,), "back", 2), story(3, (3.0,), "stand", 3)
    assert level((0.0,), nearest, same, other).contrast_of(nearest) is other
    assert level((0.0,), nearest, same).contrast_of(nearest) is same
    assert level((0.0,), nearest).contrast_of(nearest) is None
    assert level((0.0,), nearest, same, other).contrast_of(other) is nearest
