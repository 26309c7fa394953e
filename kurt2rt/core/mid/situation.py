"""What the mid level needs of its situation, whatever it is made of."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import Annotated, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import PlainValidator, SerializeAsAny

from hal.robot import SensorReadings
from hal.robot_settings import RobotSettings
from hal.settings_by_kind import KindSettings, as_its_kind
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.decision.junction_event import JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.mid.symbols.source import Transitions
from kurt2rt.core.rla.space import Metric


class MidSituation(Protocol):
    """Where the robot is, for the mid level: changes when a junction has been passed, not in between."""

    @property
    def features(self) -> tuple[str, ...]:
        """Names of the features, one per dimension."""
        ...

    @property
    def dimensions(self) -> int:
        """Length of the vector."""
        ...

    @property
    def vector(self) -> NDArray[np.float64]:
        """Shape (dimensions,). Never changed in place: where the situation changes there is a new one, so keep it."""
        ...

    @property
    def passed(self) -> JunctionEvent | None:
        """The junction that the last call of `perceive` found passed."""
        ...

    def perceive(self, senses: SensorReadings, before: Decision) -> bool:
        """Take in one tick; `before`: the decision of the tick before. Returns whether the vector has changed."""
        ...

    def restart(self) -> None:
        """Forget what was: the robot has been switched on, or set down elsewhere."""
        ...


class MidSituationSettings(KindSettings):
    """Base of the settings of every mid-level situation: a class named after its file in this folder, the kind."""

    @property
    @abstractmethod
    def features(self) -> tuple[str, ...]:
        """Names of the features, one per dimension."""

    @property
    def weights(self) -> NDArray[np.float64] | None:
        """Shape (dimensions,): how much each feature counts in a distance; None: all count 1."""
        return None

    @property
    @abstractmethod
    def metric(self) -> Metric:
        """How distances are measured."""

    def describe(self, vector: Sequence[float] | NDArray[np.float64]) -> tuple[str, ...]:
        """A situation or condition for people to read: a word per feature, empty where nothing is there yet.

        All are empty where the robot does not know where it is.
        """
        if not np.isfinite(vector).all():
            return ("",) * len(self.features)
        return tuple(f"{name} {value:.2f}" for name, value in zip(self.features, vector, strict=True))

    @abstractmethod
    def build(self, detector: JunctionDetector, robot: RobotSettings, transitions: Transitions) -> MidSituation:
        """The situation, for this robot; `transitions`: as counted up to now. Raises hal.settings.SettingsError."""


def _checked(given: object) -> MidSituationSettings:
    return as_its_kind(given, "kurt2rt.core.mid", MidSituationSettings)  # type: ignore[type-abstract]


AnyMidSituationSettings = Annotated[SerializeAsAny[MidSituationSettings], PlainValidator(_checked)]
"""In a schema: settings of whatever situation the file names."""
