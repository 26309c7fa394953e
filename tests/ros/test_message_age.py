"""Ages of messages: by stamps of clocks that agree, else by the delay against the quickest message."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.ros.message_age import DRIFT, StampedAge

NOW = 1_700_000_000.0


def test_age_with_agreeing_clocks_is_present_minus_stamp() -> None:
    assert StampedAge().on_arrival(NOW - 0.25, NOW) == 0.25


def test_age_with_clocks_apart_is_the_delay_against_the_quickest() -> None:
    age = StampedAge()
    assert age.on_arrival(100.0, NOW) == 0.0
    assert age.on_arrival(100.2, NOW + 0.7) == pytest.approx(0.5, abs=0.001)
    assert age.on_arrival(100.4, NOW + 0.4) == pytest.approx(0.0)


def test_age_of_a_message_from_the_future_is_never_negative() -> None:
    assert StampedAge().on_arrival(NOW + 5.0, NOW) == 0.0


def test_age_without_a_stamp_is_counted_from_arrival() -> None:
    assert StampedAge().on_arrival(0.0, NOW) == 0.0


def test_age_of_a_long_delay_counts_beyond_agreement() -> None:
    age = StampedAge()
    age.on_arrival(NOW, NOW + 0.01)
    assert age.on_arrival(NOW + 1.0, NOW + 4.0) == pytest.approx(2.99, abs=0.01)


def test_age_with_clocks_that_drift_apart_stays_small() -> None:
    age, drift = StampedAge(), 0.00005
    ages = [age.on_arrival(100.0 + sent * (1 - drift), NOW + sent) for sent in range(0, 36_000, 5)]
    assert max(ages) < 0.001


@given(st.floats(-1e6, 1e6), st.lists(st.floats(0.001, 0.9), min_size=2, max_size=20))
def test_age_grows_with_the_delay_whatever_the_clocks(clock_offset_s: float, delays: list[float]) -> None:
    age, quickest = StampedAge(), min(delays)
    age.on_arrival(NOW + clock_offset_s, NOW + quickest)
    for number, delay in enumerate(delays):
        sent = NOW + number
        assert age.on_arrival(sent + clock_offset_s, sent + delay) >= delay - quickest - DRIFT * len(delays) - 1e-6
