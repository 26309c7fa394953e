"""Situation from sensor readings, tick by tick."""

from kurt2rt.core.perception.perception import Perception
from tests.core.perception.helpers import READINGS, SENSORS, definition, sensed


def test_perception_situation_is_never_changed() -> None:
    perception = Perception(definition(READINGS), SENSORS)
    first = perception.perceive(sensed(10, 20, 0, 0), history_frozen=False)
    perception.perceive(sensed(99, 99, 0, 0), history_frozen=False)
    assert first.vector.tolist() == [20, 10, 20, 10]
