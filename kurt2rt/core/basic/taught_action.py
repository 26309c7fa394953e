"""Taught system as one action: it perceives for itself and reports unknown situations."""

from typing import Protocol

from hal.robot import SensorReadings, WheelSpeeds
from kurt2rt.core.decision.decision import Level
from kurt2rt.core.perception.perception import Perception


class Restartable(Protocol):
    """Part with a history, which a taught action restarts when it takes over the wheels."""

    def restart(self) -> None:
        """Forget the history; knowledge stays."""
        ...


class TaughtSystem:
    """Behaviour that drives by its own level on its own situations (paper, III.A.2)."""

    finished = False
    """Never: it goes on until the level above selects another action."""

    def __init__(self, perception: Perception, level: Level, restartable: tuple[Restartable, ...]) -> None:
        """Connect parts that belong to this action alone; `restartable` parts restart with it."""
        self._perception = perception
        self._level = level
        self._restartable = restartable
        self._driving = False
        self.lost = False
        """True while its level asks; the answer is a lesson of the level above."""

    def start(self) -> None:
        """Restart the parts of the action, so that its averages and histories are empty."""
        for part in self._restartable:
            part.restart()
        self._driving = self.lost = False

    def step(self, readings: SensorReadings) -> WheelSpeeds:
        """Return the wheel speeds that the action's own level decides in this tick.

        While the action is lost, the speeds are 0 and its averages stand still.
        """
        situation = self._perception.perceive(readings, history_frozen=not self._driving)
        decision = self._level.decide(situation, readings, None)
        self._driving, self.lost = decision.driving, decision.asking
        if self._driving:
            self._perception.remember_driven(decision.wheel_speeds)
        return decision.wheel_speeds
