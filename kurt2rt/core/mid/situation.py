"""Protocol of mid-level situations, and base of their settings."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import Annotated, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import PlainValidator, SerializeAsAny

from config.settings_by_kind import KindSettings, as_its_kind
from hal.robot import SensorReadings
from hal.robot_settings import RobotSettings
from kurt2rt.core.decision.decision import JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.rla.condition import Metric


class MidSituation(Protocol):
    """Situation of the mid level; it changes at junctions only."""

    @property
    def features(self) -> tuple[str, ...]:
        """Names of the features, one per dimension."""
        ...

    @property
    def dimensions(self) -> int:
        """Length d of the situation vector of this level."""
        ...

    @property
    def vector(self) -> NDArray[np.float64]:
        """Situation, shape (dimensions,); a change makes a new array."""
        ...

    @property
    def passed(self) -> JunctionEvent | None:
        """Junction passed in the last call of `perceive`; None without one."""
        ...

    def perceive(self, readings: SensorReadings) -> bool:
        """Process one tick; return whether the vector changed."""
        ...

    def restart(self) -> None:
        """Reset after power-on or repositioning."""
        ...


class MidSituationSettings(KindSettings):
    """Base of the settings of mid-level situations; the class is named after its file, the kind."""

    @property
    @abstractmethod
    def features(self) -> tuple[str, ...]:
        """Names of the features, one per dimension."""

    @property
    def weights(self) -> NDArray[np.float64] | None:
        """Weight of each feature in a distance, shape (dimensions,); None: all 1."""
        return None

    @property
    @abstractmethod
    def metric(self) -> Metric:
        """Metric of the distances between situations of this kind."""

    def describe(self, vector: Sequence[float] | NDArray[np.float64]) -> tuple[str, ...]:
        """Return a text per feature of a situation or condition (d,); all empty for an unknown position."""
        if not np.isfinite(vector).all():
            return ("",) * len(self.features)
        return tuple(f"{name} {value:.2f}" for name, value in zip(self.features, vector, strict=True))

    @abstractmethod
    def build(self, detector: JunctionDetector, robot: RobotSettings) -> MidSituation:
        """Return the situation at power-on. Raises config.settings.SettingsError."""


def _checked(given: object) -> MidSituationSettings:
    return as_its_kind(given, "kurt2rt.core.mid", MidSituationSettings)  # type: ignore[type-abstract]


AnyMidSituationSettings = Annotated[SerializeAsAny[MidSituationSettings], PlainValidator(_checked)]
"""Schema type: settings of the kind that a file names."""
