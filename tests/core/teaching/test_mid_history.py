"""The mid level's situations of the last junctions, by ticks."""

import numpy as np

from kurt2rt.core.teaching.mid_lessons import MidHistory, MidSnapshot


def remembered(*spells: tuple[int, int, int | None], capacity: int = 64) -> MidHistory:
    """Return a history with one situation of each (first tick, last tick, RLA): the number of its first tick."""
    recent = MidHistory(capacity)
    for first, last, rla_id in spells:
        vector = np.array([float(first)])
        for tick in range(first, last + 1):
            recent.remember(tick, vector, rla_id)
    return recent


def told(moment: MidSnapshot | None) -> tuple[float, int | None] | None:
    return None if moment is None else (moment.vector.item(), moment.rla_id)


def test_mid_history_outside_its_ticks_returns_none() -> None:
    assert MidHistory().get(0) is None
    assert MidHistory().newest is None
    recent = remembered((5, 9, 1))
    assert [told(recent.get(tick)) for tick in (4, 5, 9, 10)] == [None, (5.0, 1), (5.0, 1), None]


def test_mid_history_stores_one_snapshot_per_junction() -> None:
    recent = remembered((1, 90_000, 4), (90_001, 90_001, 5), (90_002, 200_000, None), capacity=3)
    assert [told(recent.get(tick)) for tick in (1, 90_000, 90_001, 90_002, 150_000)] == [
        (1.0, 4),
        (1.0, 4),
        (90_001.0, 5),
        (90_002.0, None),
        (90_002.0, None),
    ]
    assert told(recent.newest) == (90_002.0, None)


def test_memory_does_not_grow_and_the_oldest_is_forgotten() -> None:
    recent = remembered(*((tick, tick, tick) for tick in range(100)), capacity=10)
    assert recent.get(89) is None
    assert told(recent.get(90)) == (90.0, 90)
