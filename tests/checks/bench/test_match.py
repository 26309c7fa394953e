"""Benchmark of the match against brute force."""

import pytest

from kurt2rt.checks.bench.match import SIZES, Size, WrongWinnerError, measure_match
from kurt2rt.core.rla.matching import ConditionIndex
from kurt2rt.core.rla.near_conditions import NearestCondition


def test_each_size_has_its_row_with_reference_and_goal() -> None:
    told: list[float] = []
    results = measure_match((Size(2, 1e9, 30), Size(135, 0.0, 30)), told.append)
    assert told == [0.5, 1.0]
    assert [result.what.split()[-2] for result in results] == ["2", "135"]
    assert [[goal.met for goal in result.goals] for result in results] == [[True], [False]]
    for result in results:
        assert 0.0 < result.took.median_us <= result.took.p99_us <= result.took.worst_us
        assert result.reference is not None
        assert result.reference.ratio == pytest.approx(result.reference.took_us / result.took.median_us)


def test_the_sizes_are_those_of_the_paper_and_beyond() -> None:
    assert [(size.rlas, size.limit_us) for size in SIZES] == [(135, 10.0), (1_000, 15.0), (100_000, 1500.0)]


def test_a_match_that_is_wrong_is_not_timed(monkeypatch: pytest.MonkeyPatch) -> None:
    def always_the_first(index: ConditionIndex, situation: object) -> NearestCondition:
        assert len(index) > 1
        assert situation is not None
        return NearestCondition(0, 0.0, 1, 0.0)

    monkeypatch.setattr(ConditionIndex, "nearest", always_the_first)
    with pytest.raises(WrongWinnerError):
        measure_match((Size(50, 1.0, 100),), lambda _: None)
