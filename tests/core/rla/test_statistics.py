"""Counts of uses and transitions."""

from kurt2rt.core.rla.statistics import StatisticsCounter


def drive(statistics: StatisticsCounter, ticks: list[int | None]) -> None:
    for rla_id in ticks:
        statistics.count(rla_id)


def test_usage_counter_drop_deleted_removes_edges() -> None:
    statistics = StatisticsCounter()
    drive(statistics, [1, 2, 3, 1, 2])
    statistics.drop_deleted({1, 3}.__contains__)
    assert statistics.uses == {1: 2, 3: 1}
    assert statistics.transitions == {(3, 1): 1}
    drive(statistics, [3])
    assert statistics.transitions == {(3, 1): 1}


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
