"""Turn since the robot last turned the other way."""

import math

import pytest

from kurt2rt.core.critic.appraisal_features import TurnMemory


def turned(memory: TurnMemory, total_rad: float, ticks: int = 100) -> float:
    """Return the memory after a turn in equal parts."""
    for _ in range(ticks):
        now_rad = memory.update(total_rad / ticks)
    return now_rad


def test_turn_memory_counts_whole_rounds() -> None:
    assert turned(TurnMemory(0.6), 4 * math.pi) == pytest.approx(4 * math.pi)
    assert turned(TurnMemory(0.6), -4 * math.pi) == pytest.approx(-4 * math.pi)


def test_turn_memory_small_turn_back_is_subtracted() -> None:
    memory = TurnMemory(0.6)
    turned(memory, 3.0)
    assert turned(memory, -0.5) == pytest.approx(2.5)
    assert turned(memory, 1.0) == pytest.approx(3.5)


def test_turn_memory_reversal_begins_at_the_farthest_turn() -> None:
    memory = TurnMemory(0.6)
    turned(memory, 5.0)
    assert turned(memory, -0.7) == pytest.approx(-0.7)
    assert turned(memory, -0.3) == pytest.approx(-1.0)
    assert turned(memory, 2.0) == pytest.approx(2.0)


def test_turn_memory_wobbling_straight_course_stays_small() -> None:
    memory = TurnMemory(0.6)
    for _ in range(50):
        turned(memory, 0.3)
        assert abs(turned(memory, -0.3)) < 0.6


def test_turn_memory_fades_over_the_way() -> None:
    memory = TurnMemory(0.6, fades_in_m=0.3)
    turned(memory, 5.0)
    for _ in range(300):
        left_rad = memory.update(0.0, 0.001)
    assert left_rad == pytest.approx(5.0 / math.e, rel=0.01)
    assert memory.update(0.0, -1.0) == 0.0


def test_turn_memory_restart_forgets() -> None:
    memory = TurnMemory(0.6)
    turned(memory, 5.0)
    memory.restart()
    assert turned(memory, 0.1) == pytest.approx(0.1)
