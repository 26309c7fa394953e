import re

import pytest

from kurt2rt.experiments.study.eligibility import reasons_against_judging


@pytest.mark.parametrize(
    ("seeds", "numbers"),
    [
        (range(100, 120), []),
        (range(80, 100), []),
        (range(100, 119), [["19", "20"]]),
        (range(79, 99), [["1", "0", "79"]]),
        (range(2990, 3010), [["10", "3000", "3999"]]),
    ],
)
def test_only_enough_robots_that_nobody_has_seen_are_judged(seeds: range, numbers: list[list[str]]) -> None:
    assert [re.findall(r"\d+", each) for each in reasons_against_judging(seeds)] == numbers
