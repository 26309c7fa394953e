"""What the tick needs of the layer that has the wheels."""

from typing import Protocol

from hal.robot import SensorReadings
from kurt2rt.core.decision.decision import Cause, Decision
from kurt2rt.core.perception.perception import Situation


class Level(Protocol):
    """Answers each situation with a decision."""

    def decide(self, situation: Situation, senses: SensorReadings, blocking_cause: Cause | None) -> Decision:
        """Decide this tick; with a reason to stand, stand."""
        ...
