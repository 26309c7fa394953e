"""Interface between the tick and the level that drives."""

from typing import Protocol

from hal.robot import SensorReadings
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.perception.perception import Situation


class Level(Protocol):
    """Layer that answers each situation with a decision."""

    def decide(self, situation: Situation, readings: SensorReadings, blocking_cause: DecisionCause | None) -> Decision:
        """Return the decision of this tick; with a blocking cause, one at standstill.

        `situation`: vector (d,).
        """
        ...
