"""Schema of `config/mid_levels/*.yaml`."""

import hashlib
import json
from pathlib import Path
from typing import Annotated

from pydantic import Field

from hal.robot_settings import RobotSettings
from hal.settings import Settings, find_config, load_settings
from kurt2rt.core.mid.junction_detector import JunctionDetector, JunctionDetectorSettings
from kurt2rt.core.mid.situation import AnyMidSituationSettings, MidSituation
from kurt2rt.core.mid.symbols.source import Transitions
from kurt2rt.core.rla.feature_set import LevelFeatures
from kurt2rt.core.rla.space import Space

Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=64)]
Share = Annotated[float, Field(ge=0, le=1)]


class MidLearningSettings(Settings):
    """How the mid level's RLA system matches and takes lessons."""

    radius: Annotated[float, Field(ge=0, le=100_000)]
    """Confidence radius R; of histories: how many places may differ (paper: 6 of 12). 0: only what was taught."""
    insert_beyond_share: Share
    """A correction farther than this share of R from the nearest condition inserts a new RLA, else it replaces."""


class MidSettings(Settings):
    """The mid level, whole."""

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
        """What distances of the mid level are measured in."""
        situation = self.situation
        return Space(len(situation.features), self.learning.radius, situation.weights, situation.metric)

    @property
    def feature_hash(self) -> str:
        """Fingerprint of what the features are; mid-level RLAs are refused under another.

        How distances are measured is no part of it, nor is the radius: with others the same RLAs have other borders.
        """
        situation = self.situation.model_dump(mode="json")
        situation.pop("distance", None)
        content = {"junctions": self.junctions.model_dump(mode="json"), "situation": situation}
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]

    def build(self, robot: RobotSettings, transitions: Transitions | None = None) -> MidSituation:
        """The situation, for this robot, as if just switched on. Raises hal.settings.SettingsError.

        `transitions`: which RLA followed which how often, as counted up to now.
        """
        return self.situation.build(JunctionDetector(self.junctions, robot), robot, transitions or {})


def load_mid_level(name_or_path: str | MidSettings) -> MidSettings:
    """Settings of a shipped mid level by name, or of a file by path; settings are taken as they are.

    Raises hal.settings.SettingsError.
    """
    if isinstance(name_or_path, MidSettings):
        return name_or_path
    return load_settings(Path(find_config("mid_levels", name_or_path)), MidSettings)
