"""Schema of `config/critics/*.yaml`."""

import hashlib
import json
from pathlib import Path
from typing import Annotated, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator, model_validator

from behaviors.judges.judge import AppraisalFeatures
from hal.settings import Settings, find_config, load_settings
from kurt2rt.core.rla.feature_set import LevelFeatures

Seconds = Annotated[float, Field(gt=0, le=100_000)]
Metres = Annotated[float, Field(gt=0, le=10)]
Share = Annotated[float, Field(ge=0, le=1)]
Weight = Annotated[float, Field(ge=0, le=1000)]
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=64)]
Sensors = Annotated[tuple[str, ...], Field(min_length=1)]

*_ALWAYS, SURPRISED = AppraisalFeatures._fields
NAMES = tuple(_ALWAYS)
"""Of the features of an appraisal situation, in their order; a critic may look at SURPRISED, too."""


class AppraisalSettings(Settings):
    """One signal that the critic can give: an action of its RLAs."""

    name: Name
    value: Annotated[int, Field(ge=-1, le=1)]
    trace_s: Seconds
    """Time constant of the eligibility trace: how far back it reaches."""


class SideSensors(Settings):
    """Which sensors look to which side; left and right from front to back."""

    left: Annotated[Sensors, Field(min_length=2)]
    right: Annotated[Sensors, Field(min_length=2)]
    front: Sensors
    rear: Sensors
    ahead_left: Sensors
    ahead_right: Sensors
    wall: Sensors
    """Those that look for the wall that is gone after a while without."""

    @property
    def used(self) -> frozenset[str]:
        """All of them."""
        return frozenset(name for names in self.model_dump().values() for name in names)


class AppraisalPerceptionSettings(Settings):
    """How circumstances are told from senses."""

    sensors: SideSensors
    wall_m: Metres
    """Farther than this is no wall: it has no angle."""
    no_wall_s: Seconds
    """The wall is gone when its sensors have seen none for so long."""
    smoothing_s: Seconds
    """Time constant of speed and turn rate."""
    bump_held_s: Seconds
    no_progress_s: Annotated[float, Field(gt=0, le=60)]
    no_progress_m: Metres
    """Less way than this in that time, from where to where, while it drives, is no progress."""
    surprise_held_s: Seconds | None = None
    """Something surprising (kurt2rt.core.expectations) is a circumstance for so long; left out: it is none."""


class AppraisalWeights(Settings):
    """What each circumstance counts in a distance; nothing where it is left out. One for each of AppraisalFeatures."""

    left_m: Weight = 0.0
    front_m: Weight = 0.0
    right_m: Weight = 0.0
    rear_m: Weight = 0.0
    ahead_left_m: Weight = 0.0
    ahead_right_m: Weight = 0.0
    left_angle_rad: Weight = 0.0
    right_angle_rad: Weight = 0.0
    speed_m_s: Weight = 0.0
    turn_rad_s: Weight = 0.0
    bumped: Weight = 0.0
    no_progress: Weight = 0.0
    no_wall: Weight = 0.0
    surprised: Weight = 0.0

    @model_validator(mode="after")
    def _something_counts(self) -> Self:
        if not any(getattr(self, name) for name in (*NAMES, SURPRISED)):
            raise ValueError("every circumstance weighs 0; give one more")
        return self


class CriticLearningSettings(Settings):
    """How the critic's RLA system matches and takes lessons."""

    radius: Annotated[float, Field(gt=0, le=100_000)]
    insert_beyond_share: Share
    """Another opinion farther than this share of the radius from the nearest condition inserts, else it replaces."""
    weights: AppraisalWeights


class AgreementSettings(Settings):
    """When the critic is trusted."""

    bound: Share
    """It may act while its agreement with its teacher is at least this."""
    window: Annotated[int, Field(ge=1, le=10_000)]
    """The last signals of each value that count."""
    least: Annotated[int, Field(ge=1, le=10_000)]
    """Of these so many must have been heard."""
    apart_s: Annotated[float, Field(ge=0, le=1000)]
    """Between two signals that count, agreeing or not: else what was just taught would be measured, or one place many
    times.
    """

    @model_validator(mode="after")
    def _window_holds_the_least(self) -> Self:
        if self.least > self.window:
            raise ValueError(f"least is {self.least}, allowed is at most window ({self.window})")
        return self


class SignalEverySettings(Settings):
    """The shortest time between two signals of one value."""

    bad: Seconds
    good: Seconds


class ActivationSettings(Settings):
    """When a critic that is trusted begins to act: what drives well enough is left alone."""

    bad_share: Share
    """It acts once it has found this share of the driven time bad, and then until phase 5 ends; 0: always."""
    mean_s: Seconds
    """Time constant of that share, in driven time."""
    first_s: Annotated[float, Field(ge=0, le=100_000)]
    """Not before phase 5 has lasted so long."""


class RollbackSettings(Settings):
    """The guard that keeps the best knowledge."""

    window_s: Seconds
    """Time of driving after which a score is told."""
    margin: Annotated[float, Field(ge=0, le=2)]
    """A score that is lower than the best one by more than this rolls back."""


class CriticSettings(Settings):
    """The critic, whole."""

    name: Name
    appraisals: Annotated[tuple[AppraisalSettings, ...], Field(min_length=1)]
    perception: AppraisalPerceptionSettings
    learning: CriticLearningSettings
    think_every_ticks: Annotated[int, Field(ge=1, le=100)]
    """How often it is looked up what it thinks."""
    agreement: AgreementSettings
    signal_every_s: SignalEverySettings
    patience_s: Annotated[float, Field(ge=0, le=10)]
    """It gives a signal only when it has thought the same for so long."""
    need: ActivationSettings
    best: RollbackSettings

    @field_validator("appraisals")
    @classmethod
    def _bad_and_good_are_there(cls, appraisals: tuple[AppraisalSettings, ...]) -> tuple[AppraisalSettings, ...]:
        names = [each.name for each in appraisals]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ValueError(f"{', '.join(twice)} stands twice; leave one out")
        if not {-1, 1} <= {each.value for each in appraisals}:
            raise ValueError("there must be one of value -1 and one of value 1")
        return appraisals

    @model_validator(mode="after")
    def _surprise_is_weighed_where_it_is_seen(self) -> Self:
        if self.learning.weights.surprised and self.perception.surprise_held_s is None:
            raise ValueError("learning.weights.surprised weighs nothing; say perception.surprise_held_s, too")
        return self

    @property
    def level_features(self) -> LevelFeatures:
        """Names and fingerprint of the circumstances, for a knowledge file."""
        return LevelFeatures(self.feature_hash, self.names)

    @property
    def names(self) -> tuple[str, ...]:
        """Of the features that it looks at."""
        return NAMES if self.perception.surprise_held_s is None else (*NAMES, SURPRISED)

    @property
    def weight_vector(self) -> NDArray[np.float64]:
        """Weights (d,) in the order of its features."""
        return np.array([getattr(self.learning.weights, name) for name in self.names], dtype=np.float64)

    @property
    def values(self) -> dict[str, int]:
        """What each appraisal is worth, by its name."""
        return {each.name: each.value for each in self.appraisals}

    @property
    def feature_hash(self) -> str:
        """Fingerprint of what the circumstances are; appraisals are refused under another.

        Radius, weights and the rest are no part of it: with other ones the same appraisals have other borders.
        """
        perception = self.perception.model_dump(mode="json", exclude_none=True)
        content = {"names": list(self.names), "perception": perception}
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


def load_critic(name_or_path: str | CriticSettings = "basic") -> CriticSettings:
    """Settings of a shipped critic by name, or of a file by path; settings are taken as they are.

    Raises hal.settings.SettingsError.
    """
    if isinstance(name_or_path, CriticSettings):
        return name_or_path
    return load_settings(Path(find_config("critics", name_or_path)), CriticSettings)
