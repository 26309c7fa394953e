"""Counts behind the RLA network."""

from kurt2rt.core.rla.rla import MID
from kurt2rt.core.rla.usage_counter import StatisticsCounter


def drive(statistics: StatisticsCounter, ticks: list[int | None]) -> None:
    for rla_id in ticks:
        statistics.count(rla_id)


def test_an_rla_is_used_once_however_many_ticks_it_drives() -> None:
    statistics = StatisticsCounter()
    drive(statistics, [1, 1, 1, 2, 2, 1])
    assert statistics.uses == {1: 2, 2: 1}
    assert statistics.transitions == {(1, 2): 1, (2, 1): 1}


def test_standing_ends_a_chain_of_transitions() -> None:
    statistics = StatisticsCounter()
    drive(statistics, [1, None, None, 2, None, 2])
    assert statistics.uses == {1: 1, 2: 2}
    assert not statistics.transitions


def test_counting_goes_on_from_what_was_kept() -> None:
    statistics = StatisticsCounter({1: 10}, {(1, 2): 4})
    drive(statistics, [1, 2])
    assert statistics.uses == {1: 11, 2: 1}
    assert statistics.transitions == {(1, 2): 5}


def test_the_dead_are_dropped_and_what_drove_last_is_no_way_to_what_comes() -> None:
    statistics = StatisticsCounter()
    drive(statistics, [1, 2, 3, 1, 2])
    statistics.drop_deleted({1, 3}.__contains__)
    assert statistics.uses == {1: 2, 3: 1}
    assert statistics.transitions == {(3, 1): 1}
    drive(statistics, [3])
    assert statistics.transitions == {(3, 1): 1}


def test_each_level_has_a_chain_of_its_own_in_the_same_tables() -> None:
    statistics = StatisticsCounter()
    for basic, mid in ((1, 8), (2, 8), (2, 9), (1, 9)):
        statistics.count(basic)
        statistics.count(mid, MID)
    assert statistics.uses == {1: 2, 2: 1, 8: 1, 9: 1}
    assert statistics.transitions == {(1, 2): 1, (2, 1): 1, (8, 9): 1}
    statistics.drop_deleted({1, 2, 8}.__contains__)
    statistics.count(8, MID)
    assert statistics.transitions == {(1, 2): 1, (2, 1): 1}


def test_what_is_decided_anew_is_another_use_though_it_be_the_same_rla() -> None:
    statistics = StatisticsCounter()
    for anew in (True, False, True):
        statistics.count(8, MID, again=anew)
    assert statistics.uses == {8: 2}
    assert statistics.transitions == {(8, 8): 1}


def test_what_followed_an_rla_is_forgotten_with_its_action_but_not_what_it_followed() -> None:
    statistics = StatisticsCounter()
    drive(statistics, [1, 2, 3, 1, 2])
    statistics.drop_follow_ups(2)
    assert statistics.transitions == {(1, 2): 2, (3, 1): 1}
    drive(statistics, [3])
    assert statistics.transitions == {(1, 2): 2, (3, 1): 1}
    assert statistics.uses == {1: 2, 2: 2, 3: 2}


def test_what_followed_one_rla_is_told_without_the_others() -> None:
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
