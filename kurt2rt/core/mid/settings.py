"""Schema of `config/mid_levels/*.yaml`, and the protocol of mid-level situations."""

from abc import abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PlainValidator, SerializeAsAny

from config.settings import Settings, load_settings
from config.settings_by_kind import KindSettings, as_its_kind
from config.settings_files import find_config
from hal.robot import SensorReadings
from hal.robot_settings import RobotSettings
from kurt2rt.core.decision.decision import JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector, JunctionDetectorSettings
from kurt2rt.core.rla.condition import LevelFeatures, Metric, Space
from kurt2rt.core.settings_fields import Name, Share, fingerprint


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


class MidLearningSettings(Settings):
    """Settings by which the mid level matches situations to RLAs and places lessons."""

    radius: Annotated[float, Field(ge=0, le=100_000)]
    """Confidence radius R; of histories the number of different places (paper: 6 of 12). 0: equal situations only."""
    insert_radius_fraction: Share
    """Share of R beyond which a correction inserts an RLA; nearer it replaces the action."""


class MidSettings(Settings):
    """Schema of a mid level's file: detection of junctions, its situations, and how it learns."""

    name: Name
    junctions: JunctionDetectorSettings
    situation: AnyMidSituationSettings
    learning: MidLearningSettings

    @property
    def level_features(self) -> LevelFeatures:
        """Names and fingerprint of the mid-level features, for a knowledge file."""
        return LevelFeatures(self.feature_hash, self.features)

    @property
    def features(self) -> tuple[str, ...]:
        """Names of the features of a mid-level condition, one per dimension."""
        return self.situation.features

    @property
    def space(self) -> Space:
        """Space of the mid level."""
        situation = self.situation
        return Space(len(situation.features), self.learning.radius, situation.weights, situation.metric)

    @property
    def feature_hash(self) -> str:
        """Fingerprint of the features; mid-level RLAs with another one are refused.

        The radius is not part of it: it only moves the borders between RLAs.
        """
        content = {
            "junctions": self.junctions.model_dump(mode="json"),
            "situation": self.situation.model_dump(mode="json"),
        }
        return fingerprint(content)

    def build(self, robot: RobotSettings) -> MidSituation:
        """Return the situation at power-on for a robot. Raises config.settings.SettingsError."""
        return self.situation.build(JunctionDetector(self.junctions, robot), robot)


def load_mid_level(name_or_path: str | MidSettings) -> MidSettings:
    """Return the settings of a built-in mid level by name, or of a file by path; settings are returned unchanged.

    Raises config.settings.SettingsError.
    """
    if isinstance(name_or_path, MidSettings):
        return name_or_path
    return load_settings(Path(find_config("mid_levels", name_or_path)), MidSettings)
