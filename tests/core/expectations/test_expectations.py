"""Expectations learned from ends of RLAs, and surprises."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.core.rla.statistics import pack
from tests.core.expectations.helpers import Small
from tests.core.rla.helpers import deleted, undone

PLACES = st.tuples(st.floats(-1000, 1000), st.floats(-1000, 1000))


@given(st.lists(PLACES, min_size=2, max_size=50))
def test_learn_mean_and_spread_of_all_ends(places: list[tuple[float, float]]) -> None:
    small = Small()
    for place in places:
        small.ends(1, 2, *place)
    expected = small.expected(1)
    assert expected.count == len(places)
    assert expected.mean == pytest.approx(np.mean(places, axis=0), abs=1e-9)
    assert expected.spread == pytest.approx(np.std(places, axis=0, ddof=1), abs=1e-4)


def test_surprise_only_for_distant_ends() -> None:
    small = Small()
    for number in range(20):
        small.ends(1, 2, 50.0 + number % 2, 20.0)
    as_ever, off = small.ends(1, 2, 50.5, 20.0), small.ends(1, 2, 50.0, 80.0)
    assert as_ever is not None
    assert not as_ever.surprising
    assert off is not None
    assert off.surprising
    assert off.distance == pytest.approx(60.0, abs=0.01)
    assert off.multiple == pytest.approx(60.0 / 0.5, rel=0.05)
    assert (off.rla_id, off.follow_up, off.ends) == (1, 2, 21)


def test_surprise_new_follow_up_is_marked() -> None:
    small = Small()
    for _ in range(5):
        small.ends(1, 2, 50.0, 20.0)
    new, again = small.ends(1, 3, 50.0, 20.0), small.ends(1, 3, 50.0, 20.0)
    assert new is not None
    assert again is not None
    assert [new.new_follow_up, again.new_follow_up] == [True, False]
    assert (again.seen, again.ends) == (1, 6)


def test_on_event_restored_rla_has_no_expectation() -> None:
    small = Small()
    small.ends(1, 2, 5.0, 5.0)
    small.expectations.snapshot()
    small.happens(deleted(1))
    assert small.expectations.snapshot() == {}
    assert small.ends(1, 2, 5.0, 5.0) is None
    assert small.expectations.get(1) is None
    small.happens(undone("deletion-1"))
    assert small.expectations.get(1) is None
    small.ends(1, 2, 6.0, 5.0)
    assert small.expected(1).mean.tolist() == [6.0, 5.0]


@pytest.mark.parametrize("metric", ["euclidean", "hamming"])
def test_snapshot_restores_expectations(metric: str) -> None:
    situations = [tuple(float((7 * step + place) % 3) for place in range(3)) for step in range(12)]
    whole, first = Small("hamming"), Small("hamming")
    if metric == "euclidean":
        whole, first = Small(), Small()
        situations = [situation[:2] for situation in situations]
    for situation in situations:
        whole.ends(1, 2, *situation)
    for situation in situations[:7]:
        first.ends(1, 2, *situation)
    second = Small("hamming" if metric == "hamming" else "euclidean", first.expectations.snapshot())
    for situation in situations[7:]:
        second.ends(1, 2, *situation)
    assert second.expected(1) == whole.expected(1)  # to the last bit


def test_restore_other_dimensions_is_refused() -> None:
    small = Small()
    small.ends(1, 2, 5.0, 5.0)
    narrow = replace(small.expected(1), packed_mean=pack(np.zeros(1)))
    with pytest.raises(ValueError, match=r"RLA 1 .*\b1 .*\b2 .*\b2 "):
        Small(saved={1: narrow})
