"""Counts of uses and transitions."""

from kurt2rt.core.rla.rla import MID
from kurt2rt.core.rla.usage_counter import StatisticsCounter


def drive(statistics: StatisticsCounter, ticks: list[int | None]) -> None:
    for rla_id in ticks:
        statistics.count(rla_id)


def test_usage_counter_standstill_ends_the_chain() -> None:
    statistics = StatisticsCounter()
    drive(statistics, [1, None, None, 2, None, 2])
    assert statistics.uses == {1: 1, 2: 2}
    assert not statistics.transitions


def test_usage_counter_drop_deleted_removes_edges() -> None:
    statistics = StatisticsCounter()
    drive(statistics, [1, 2, 3, 1, 2])
    statistics.drop_deleted({1, 3}.__contains__)
    assert statistics.uses == {1: 2, 3: 1}
    assert statistics.transitions == {(3, 1): 1}
    drive(statistics, [3])
    assert statistics.transitions == {(3, 1): 1}


def test_usage_counter_levels_have_separate_chains() -> None:
    statistics = StatisticsCounter()
    for basic, mid in ((1, 8), (2, 8), (2, 9), (1, 9)):
        statistics.count(basic)
        statistics.count(mid, MID)
    assert statistics.uses == {1: 2, 2: 1, 8: 1, 9: 1}
    assert statistics.transitions == {(1, 2): 1, (2, 1): 1, (8, 9): 1}
    statistics.drop_deleted({1, 2, 8}.__contains__)
    statistics.count(8, MID)
    assert statistics.transitions == {(1, 2): 1, (2, 1): 1}


def test_usage_counter_again_counts_another_use() -> None:
    statistics = StatisticsCounter()
    for again in (True, False, True):
        statistics.count(8, MID, again=again)
    assert statistics.uses == {8: 2}
    assert statistics.transitions == {(8, 8): 1}


def test_usage_counter_drop_follow_ups_keeps_incoming() -> None:
    statistics = StatisticsCounter()
    drive(statistics, [1, 2, 3, 1, 2])
    statistics.drop_follow_ups(2)
    assert statistics.transitions == {(1, 2): 2, (3, 1): 1}
    drive(statistics, [3])
    assert statistics.transitions == {(1, 2): 2, (3, 1): 1}
    assert statistics.uses == {1: 2, 2: 2, 3: 2}


def test_usage_counter_follow_ups_of_one_rla() -> None:
    counter = StatisticsCounter({1: 3, 2: 1}, {(1, 2): 4})
    for current in (1, 3, 1, 2):
        counter.count(current)
    assert counter.follow_ups(1) == {2: 5, 3: 1}
    assert counter.follow_ups(9) == {}
    counter.drop_deleted(lambda rla_id: rla_id != 3)
    assert counter.follow_ups(1) == {2: 5}
    counter.drop_follow_ups(1)
    assert counter.follow_ups(1) == {}
    assert counter.transitions == {}
