"""Situation from sensor readings, tick by tick."""

from hal.robot import WheelSpeeds
from kurt2rt.core.perception.perception import Perception
from tests.core.perception.helpers import READINGS, SENSORS, WHEELS, definition, sensed


def drive_past(perception: Perception, *counts: int) -> None:
    """Fill the four steps of the history with one view."""
    for _ in range(4):
        perception.perceive(sensed(*counts), history_frozen=False)


def test_perception_recent_values_precede_averages() -> None:
    perception = Perception(definition(READINGS), SENSORS)
    drive_past(perception, 10, 20, 0, 0)
    situation = perception.perceive(sensed(20, 40, 0, 0), history_frozen=False)
    assert situation.vector.tolist() == [40, 20, 25, 12.5]
    assert not situation.history_frozen


def test_perception_frozen_history_keeps_averages() -> None:
    perception = Perception(definition(READINGS), SENSORS)
    drive_past(perception, 10, 20, 0, 0)
    for count in range(100, 300):
        situation = perception.perceive(sensed(count, count, 0, 0), history_frozen=True)
        assert situation.vector.tolist() == [count, count, 20, 10]
        assert situation.history_frozen
    situation = perception.perceive(sensed(20, 40, 0, 0), history_frozen=False)
    assert situation.vector.tolist() == [40, 20, 25, 12.5]


def test_perception_wheel_speeds_last_until_next_action() -> None:
    perception = Perception(definition(WHEELS), SENSORS)
    now = sensed(0, 0, 0, 0)
    assert perception.perceive(now, history_frozen=True).vector[:2].tolist() == [0, 0]
    perception.remember_driven(WheelSpeeds(0.3, 0.1))
    for frozen in (False, True, True):
        assert perception.perceive(now, history_frozen=frozen).vector[:2].tolist() == [10, 30]
    perception.remember_driven(WheelSpeeds(-0.2, 0.2))
    assert perception.perceive(now, history_frozen=True).vector[:2].tolist() == [20, -20]


def test_perception_situation_is_never_changed() -> None:
    perception = Perception(definition(READINGS), SENSORS)
    first = perception.perceive(sensed(10, 20, 0, 0), history_frozen=False)
    perception.perceive(sensed(99, 99, 0, 0), history_frozen=False)
    assert first.vector.tolist() == [20, 10, 20, 10]
