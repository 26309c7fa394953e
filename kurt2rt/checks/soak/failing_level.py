"""Decision layer of a soak with temporary faults."""

from hal.robot import SensorReadings
from kurt2rt.checks.faults.failing_level import FaultyLevel
from kurt2rt.checks.faults.fault_rig import RigDisturbance, SimulatedTime
from kurt2rt.core.decision.decision import Cause, Decision
from kurt2rt.core.decision.level import Level
from kurt2rt.core.perception.perception import Situation


class SoakLevel:
    """Wrapper of the deciding layer (kurt2rt.core.decision.level.Level) with temporary faults."""

    def __init__(self, time: SimulatedTime) -> None:
        self._time = time
        self._disturbed: FaultyLevel | None = None
        self.inner: Level | None = None
        """Deciding layer; set before the first tick."""

    def disturb(self, disturbance: RigDisturbance) -> None:
        """Start a fault."""
        self._disturbed = FaultyLevel(self._time, disturbance)
        self._disturbed.inner = self.inner

    def clear(self) -> None:
        """End the fault."""
        self._disturbed = None

    def decide(self, situation: Situation, senses: SensorReadings, stand_because: Cause | None) -> Decision:
        """Return the decision under the fault. Raises BrokenTickError."""
        level = self._disturbed or self.inner
        assert level is not None
        return level.decide(situation, senses, stand_because)
