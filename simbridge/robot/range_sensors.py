"""Range sensors of a simulated robot, of any kind."""

from collections.abc import Sequence
from typing import Protocol

from hal.simulation import Pose


class RangeSensors(Protocol):
    """Newest readings of all range sensors, in the order of the sensor table."""

    @property
    def counts(self) -> Sequence[int]:
        """Newest reading of each sensor, in counts."""
        ...

    @property
    def due_s(self) -> Sequence[float]:
        """Simulated times that the next measurements depend on, in s, for the state hash."""
        ...

    def measure(self, pose: Pose) -> Sequence[int]:
        """Simulate one cycle at a pose and return the indexes of the sensors with new readings."""
        ...

    def measure_all(self, pose: Pose) -> None:
        """Measure with all sensors at once, for a repositioned robot."""
        ...
