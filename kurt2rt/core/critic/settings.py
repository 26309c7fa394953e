"""Schema of `config/critics/*.yaml`, and the sensors on each side of a robot for the critic."""

import math
from pathlib import Path
from typing import Annotated, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator, model_validator

from behaviors.judges.judge import AppraisalFeatures
from behaviors.policies.sectors import Sector, ahead_first
from config.settings import Settings, load_settings
from config.settings_files import find_config
from hal.robot_settings import InfraredSettings, RobotSettings, SensorSettings
from kurt2rt.core.rla.condition import LevelFeatures
from kurt2rt.core.settings_fields import Metres, Name, Share, fingerprint

Sensors = Annotated[tuple[str, ...], Field(min_length=1)]


class SideSensors(Settings):
    """Sensors of each side; left and right from front to back."""

    left: Sensors
    right: Sensors
    front: Sensors
    rear: Sensors
    ahead_left: Sensors
    ahead_right: Sensors
    wall: Sensors
    """Sensors for the feature no_wall."""

    @property
    def used(self) -> frozenset[str]:
        """Names of the sensors of all sides."""
        return frozenset(name for names in self.model_dump().values() for name in names)


class SideSectors(Settings):
    """Sector of each side; a sensor may look into several."""

    left: Sector
    right: Sector
    front: Sector
    rear: Sector
    ahead_left: Sector
    ahead_right: Sector
    wall: Sector
    """Sector for the feature no_wall."""

    def sensors_of(self, infrared: InfraredSettings) -> SideSensors:
        """Return the sensors of each side, from front to back.

        Raises config.settings.SettingsError that names the side for a sector into which no sensor looks.
        """
        return SideSensors(
            **{side: getattr(self, side).sensors_of(infrared, f"critic: {side}") for side in SideSensors.model_fields}
        )


Seconds = Annotated[float, Field(gt=0, le=100_000)]
Weight = Annotated[float, Field(ge=0, le=1000)]

*_ALWAYS, CIRCLING, GRAZING, SPUN = AppraisalFeatures._fields
NAMES = tuple(_ALWAYS)
"""Names of the appraisal features in order; the last four are optional."""


class AppraisalSettings(Settings):
    """Opinion that the critic can be taught and then signals, such as "bad" of value -1."""

    name: Name
    value: Annotated[int, Field(ge=-1, le=1)]
    trace_s: Seconds
    """Time constant of the eligibility trace."""


class CirclingSettings(Settings):
    """Limits of the feature circling: the robot has turned to one side for more than `round_rad`."""

    round_rad: Annotated[float, Field(gt=0, le=100)]
    """Turn to one side from which on the robot is circling."""
    reversal_rad: Annotated[float, Field(gt=0, le=10)]
    """Turn to the other side that ends it; smaller ones are subtracted."""
    fades_in_m: Metres | None = None
    """Way over which an earlier turn fades to 37 %; None: it does not."""


class GrazingSettings(Settings):
    """Limits of the feature grazing: something is very near at a side."""

    near_m: Metres
    """Distance at a side, from the sensors' faces, below which something is very near."""
    held_s: Annotated[float, Field(ge=0, le=10)]
    """Duration of the feature after that: a noisy reading at the border does not make it flicker."""


class SpunSettings(Settings):
    """Limits of the feature spun: the robot turns on the spot."""

    turn_rad_s: Annotated[float, Field(gt=0, le=10)]
    """Turn rate to either side above which the robot turns on the spot, together with `speed_m_s`."""
    speed_m_s: Annotated[float, Field(gt=0, le=2)]
    """Speed, forward or backward, below which it does."""
    held_s: Annotated[float, Field(ge=0, le=10)]
    """Duration of the feature after the last such tick: wheels take time to speed up."""


class AppraisalPerceptionSettings(Settings):
    """Settings of the features that the critic judges by: sensors of both sides, distances and times."""

    sensors: SideSensors | None = None
    """Sensors of each side by name; None: by `sectors`."""
    sectors: SideSectors | None = None
    """Sectors of each side, for any robot; None as well: by the headings that are nearest to each side."""
    wall_m: Metres
    """Greatest distance of a wall; farther objects have no angle."""
    no_wall_s: Seconds
    """Time without a wall after which the feature no_wall is 1."""
    smoothing_s: Seconds
    """Time constant of speed and turn rate."""
    bump_held_s: Seconds
    no_progress_s: Annotated[float, Field(gt=0, le=60)]
    no_progress_m: Metres
    """Displacement in no_progress_s below which a driving robot makes no progress."""
    circling: CirclingSettings | None = None
    """None: the feature circling does not exist."""
    grazing: GrazingSettings | None = None
    """None: the feature grazing does not exist."""
    spun: SpunSettings | None = None
    """None: the feature spun does not exist."""

    @model_validator(mode="after")
    def _sides_are_named_once(self) -> Self:
        if self.sensors is not None and self.sectors is not None:
            raise ValueError("sensors and sectors say the same thing twice; leave one out")
        return self


class AppraisalWeights(Settings):
    """Weight of each of AppraisalFeatures in a distance; 0 by default."""

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
    circling: Weight = 0.0
    grazing: Weight = 0.0
    spun: Weight = 0.0

    @model_validator(mode="after")
    def _something_counts(self) -> Self:
        if not any(getattr(self, name) for name in AppraisalFeatures._fields):
            raise ValueError("every circumstance weighs 0; give one more")
        return self


class CriticLearningSettings(Settings):
    """Settings of matching and lessons of the critic's RLA system."""

    radius: Annotated[float, Field(gt=0, le=100_000)]
    insert_radius_fraction: Share
    """Share of the radius beyond which another opinion inserts an RLA; nearer it replaces the opinion."""
    weights: AppraisalWeights


class AgreementSettings(Settings):
    """Agreement of critic and teacher from which on the critic is trusted to act, and how it is counted."""

    bound: Share
    """Least agreement with the teacher at which the critic may act."""
    window: Annotated[int, Field(ge=1, le=10_000)]
    """Number of newest signals of each value that count."""
    least: Annotated[int, Field(ge=1, le=10_000)]
    """Least number of signals of a value."""
    apart_s: Annotated[float, Field(ge=0, le=1000)]
    """Least time between two counted signals: nearer ones would measure what was just taught."""

    @model_validator(mode="after")
    def _window_holds_the_least(self) -> Self:
        if self.least > self.window:
            raise ValueError(f"least is {self.least}, allowed is at most window ({self.window})")
        return self


class SignalEverySettings(Settings):
    """Shortest time in s between two signals of the critic of one value, -1 (`bad`) or +1 (`good`)."""

    bad: Seconds
    good: Seconds


class ActivationSettings(Settings):
    """Conditions under which a trusted critic begins to act: a robot that drives well is left alone."""

    bad_share: Share
    """Share of bad driven time that activates the critic until phase 5 ends; 0: always active."""
    mean_s: Seconds
    """Time constant of bad_share, in driven time."""
    first_s: Annotated[float, Field(ge=0, le=100_000)]
    """Duration of phase 5 before the first activation."""


class RollbackSettings(Settings):
    """Settings of the rollback: it undoes the critic's lessons if driving gets worse (`RollbackMonitor`)."""

    window_s: Seconds
    """Driving time of one scored window."""
    margin: Annotated[float, Field(ge=0, le=2)]
    """Drop below the best score that triggers a rollback."""


class CriticSettings(Settings):
    """Schema of `config/critics/*.yaml`: opinions, their features, and from when a critic is trusted."""

    name: Name
    appraisals: Annotated[tuple[AppraisalSettings, ...], Field(min_length=1)]
    perception: AppraisalPerceptionSettings
    learning: CriticLearningSettings
    think_every_ticks: Annotated[int, Field(ge=1, le=100)]
    """Ticks between two searches for an opinion."""
    agreement: AgreementSettings
    signal_every_s: SignalEverySettings
    patience_s: Annotated[float, Field(ge=0, le=10)]
    """Time that an opinion must persist before it becomes a signal."""
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
    def _optional_features_are_weighed_only_if_they_exist(self) -> Self:
        for name, setting in self._optional_features.items():
            if getattr(self.learning.weights, name) and setting is None:
                raise ValueError(f"learning.weights.{name} weighs nothing; say perception.{name}, too")
        return self

    @property
    def _optional_features(self) -> dict[str, object]:
        """Return the section of each optional feature by its name, in order."""
        want = self.perception
        return {CIRCLING: want.circling, GRAZING: want.grazing, SPUN: want.spun}

    @property
    def level_features(self) -> LevelFeatures:
        """Names and fingerprint of the appraisal features, for a knowledge file."""
        return LevelFeatures(self.feature_hash, self.names)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its features, in order."""
        return (*NAMES, *(name for name, setting in self._optional_features.items() if setting is not None))

    @property
    def weight_vector(self) -> NDArray[np.float64]:
        """Weights of its features in order, shape (d,)."""
        return np.array([getattr(self.learning.weights, name) for name in self.names], dtype=np.float64)

    @property
    def values(self) -> dict[str, int]:
        """Value of each appraisal, by name."""
        return {each.name: each.value for each in self.appraisals}

    @property
    def feature_hash(self) -> str:
        """Fingerprint of the appraisal features; appraisals with another one are refused.

        Radius and weights are not part of it: they only move the borders between appraisals.
        """
        perception = self.perception.model_dump(mode="json", exclude_none=True)
        content = {"names": list(self.names), "perception": perception}
        return fingerprint(content)


def load_critic(name_or_path: str | CriticSettings = "basic") -> CriticSettings:
    """Return the settings of a built-in critic by name, or of a file by path; settings are returned unchanged.

    Raises config.settings.SettingsError.
    """
    if isinstance(name_or_path, CriticSettings):
        return name_or_path
    return load_settings(Path(find_config("critics", name_or_path)), CriticSettings)


_SIDES_DEG = {"front": 0.0, "ahead_left": 45.0, "left": 90.0, "rear": 180.0, "right": -90.0, "ahead_right": -45.0}
_HALF_WIDTH_DEG = 22.5
_FEWEST = {"left": 2, "right": 2}


def critic_of(critic: str | CriticSettings, robot: RobotSettings) -> CriticSettings:
    """Return the critic of a task for a robot, with the sensors of each side by name.

    Sectors take the robot's sensors that look into them. The sides of a shipped critic are those of KURT2's sensors: a
    robot without these takes the sensors whose headings fit best. Raises config.settings.SettingsError.
    """
    settings = load_critic(critic)
    wanted, infrared = settings.perception, robot.infrared
    named = wanted.sensors
    if named is not None and (isinstance(critic, CriticSettings) or named.used <= set(infrared.names)):
        return settings
    sensors = sides_of(infrared) if wanted.sectors is None else wanted.sectors.sensors_of(infrared)
    perception = wanted.model_copy(update={"sensors": sensors, "sectors": None})
    return settings.model_copy(update={"perception": perception})


def sides_of(infrared: InfraredSettings) -> SideSensors:
    """Return the sensors of each side: those that look there, or else the ones whose headings are nearest to it."""
    sides = {side: _sensors_at(infrared, heading_deg, _FEWEST.get(side, 1)) for side, heading_deg in _SIDES_DEG.items()}
    return SideSensors(**sides, wall=tuple(dict.fromkeys((*sides["left"], *sides["ahead_left"]))))


def _sensors_at(infrared: InfraredSettings, heading_deg: float, fewest: int) -> tuple[str, ...]:
    """Return names of sensors from front to back."""

    def away_deg(sensor: SensorSettings) -> float:
        return abs(math.remainder(sensor.heading_deg - heading_deg, 360.0))

    nearest = sorted(infrared.sensors, key=lambda sensor: (away_deg(sensor), sensor.name))
    looking = [sensor for sensor in nearest if away_deg(sensor) <= _HALF_WIDTH_DEG]
    found = looking if len(looking) >= fewest else nearest[:fewest]
    return tuple(sensor.name for sensor in sorted(found, key=ahead_first))
