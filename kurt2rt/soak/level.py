"""The layer at the wheels, which may fail and take its tick along."""

from hal.robot import SensorReadings
from kurt2rt.faults.levels import DisturbedLevel
from kurt2rt.faults.place import Disturbance, SimulatedTime
from kurt2rt.layers.decision import Cause, Decision
from kurt2rt.layers.level import Level
from kurt2rt.perception.perception import Situation


class SoakLevel:
    """Stands before the layer that decides (kurt2rt.layers.level.Level)."""

    def __init__(self, time: SimulatedTime) -> None:
        self._time = time
        self._disturbed: DisturbedLevel | None = None
        self.behind: Level | None = None
        """The layer that really decides; set before the first tick."""

    def disturb(self, disturbance: Disturbance) -> None:
        """From now on it fails."""
        self._disturbed = DisturbedLevel(self._time, disturbance)
        self._disturbed.behind = self.behind

    def mend(self) -> None:
        """It is sound again."""
        self._disturbed = None

    def decide(self, situation: Situation, senses: SensorReadings, stand_because: Cause | None) -> Decision:
        """The decision, or what a fault makes of it. Raises BrokenTickError."""
        level = self._disturbed or self.behind
        assert level is not None
        return level.decide(situation, senses, stand_because)
