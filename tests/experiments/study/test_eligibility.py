import pytest

from kurt2rt.experiments.study.eligibility import reasons_against_judging


@pytest.mark.parametrize(
    ("seeds", "reasons"),
    [
        (range(100, 120), []),
        (range(80, 100), []),
        (range(100, 119), ["19 robots only; the numbers are asked of 20."]),
        (range(79, 99), ["1 of the seeds are among 0 to 79, on which settings were chosen; give others."]),
    ],
)
def test_only_enough_robots_that_nobody_has_seen_are_judged(seeds: range, reasons: list[str]) -> None:
    assert list(reasons_against_judging(seeds)) == reasons
