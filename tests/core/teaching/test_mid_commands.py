"""The mid level's situations of the last junctions, by ticks."""

import numpy as np

from kurt2rt.core.teaching.mid_commands import MidHistory, MidSnapshot


def remembered(*spells: tuple[int, int, int | None]) -> MidHistory:
    """Return a history with one situation of each (first tick, last tick, RLA): the number of its first tick."""
    recent = MidHistory()
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
