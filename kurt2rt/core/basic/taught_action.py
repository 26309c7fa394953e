"""A taught system as one action: it perceives for itself, and tells when it does not know how to go on."""

from typing import Protocol

from hal.robot import SensorReadings, WheelSpeeds
from kurt2rt.core.decision.level import Level
from kurt2rt.core.perception.perception import Perception


class Restartable(Protocol):
    """A part that remembers what was."""

    def restart(self) -> None:
        """Forget it; what was taught stays."""
        ...


class TaughtSystem:
    """Drives as its own level decides, on its own situations; a behaviour (paper, III.A.2)."""

    finished = False
    """What was taught goes on until the layer above wants something else."""

    def __init__(self, perception: Perception, level: Level, restartable: tuple[Restartable, ...]) -> None:
        """All are this action's alone. `remembering`: what of them begins anew when it does."""
        self._perception = perception
        self._level = level
        self._restartable = restartable
        self._driving = False
        self.lost = False
        """Whether its level asks: what it asks about has to be answered in the layer above."""

    def start(self) -> None:
        """Forget how it was before; the past begins where the robot is now."""
        for part in self._restartable:
            part.restart()
        self._driving = self.lost = False

    def step(self, senses: SensorReadings) -> WheelSpeeds:
        """What its level decides. While it is lost it stands, and its averages stand still as a waiting robot's do."""
        situation = self._perception.perceive(senses, history_frozen=not self._driving)
        decision = self._level.decide(situation, senses, None)
        self._driving, self.lost = decision.driving, decision.asking
        if self._driving:
            self._perception.remember_driven(decision.wheel_speeds)
        return decision.wheel_speeds
