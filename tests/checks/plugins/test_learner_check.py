"""Check of learners: the time of decisions."""

from collections.abc import Iterator

import numpy as np
import pytest

from kurt2rt.checks.plugins.learner_check import check_learner
from kurt2rt.core.learner.neighbours import NearestNeighbour
from tests.core.learner.helpers import SETTING

WIDE = SETTING._replace(dimensions=12, weights=np.ones(12), radius=300.0)


def taking(milliseconds: float) -> Iterator[int]:
    """Yield times in ns of a clock that goes on by so much in each decision, and fifty times that in the first."""
    now_ns = 0
    for place in range(1_000):
        yield now_ns
        yield (now_ns := now_ns + round(milliseconds * 1e6) * (50 if place == 0 else 1))


@pytest.mark.parametrize(
    ("milliseconds", "told"),
    [
        (0.25, "decide takes 0.25 ms in the median and 0.25 ms at most after 40 lessons, and 12 ms when it is first"),
        (30.0, "warning: decide takes 30 ms in the median and 30 ms at most after 40 lessons, and 1500 ms when it is"),
    ],
)
def test_time_to_decide_is_told_in_words(milliseconds: float, told: str) -> None:
    broken, note = check_learner(NearestNeighbour, WIDE, taking(milliseconds).__next__)
    assert broken == []
    assert note.startswith(told)
    assert ("so a robot would stand" in note) == (milliseconds > 20.0)
