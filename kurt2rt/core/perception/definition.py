"""Schema of `config/situations/*.yaml`: the features of a situation, and the hash that knowledge is bound to."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from config.errors import guess
from config.settings import Settings, SettingsError, load_settings
from config.settings_files import find_config
from hal.robot import HIGHEST_COUNTS
from kurt2rt.core.settings_fields import fingerprint
from simbridge.contracts.batch import FeatureKind

AVERAGED = " (10 s average)"
"""Suffix of the names of averaged features."""

Heading = Literal["front", "left", "right", "rear"]


class Feature(Settings, ABC):
    """Feature as a situation's file defines it. A new kind is a class here, and stands in `AnyFeature`.

    `scale`: the definition's `wheel_speed_counts_per_m_s`.
    """

    kind: str

    @property
    @abstractmethod
    def name(self) -> str:
        """Name shown to the teacher."""

    @property
    def sensors_used(self) -> tuple[str, ...]:
        """Names of the distance sensors whose counts alone decide its value; none if anything else does."""
        return ()

    @abstractmethod
    def expression(self, counts: Sequence[str]) -> str:
        """Return Python for its whole number, of the `counts` of `sensors_used` and what `compile_features` names."""

    @abstractmethod
    def bounds(self, top_speed: int) -> tuple[int, int]:
        """Return its lowest and its highest value; `top_speed`: greatest wheel speed times the scale."""

    def measured(self, names: Mapping[str, str]) -> tuple[object, ...]:
        """Return what it measures, with other `names` for sensors and sides: features of equal tuples are the same."""
        return (self.kind, *(names[sensor] for sensor in self.sensors_used))

    def batch_kind(self, scale: int) -> FeatureKind | None:  # noqa: ARG002 - for wheel speeds
        """Return what a compiled batch computes, by the kind's name; None: the batch refuses the feature."""
        return FeatureKind.__members__.get(self.kind.upper())


class _OfCounts(Feature, ABC):
    """Feature of the counts of distance sensors."""

    def bounds(self, top_speed: int) -> tuple[int, int]:  # noqa: ARG002 - for wheel speeds
        return 0, HIGHEST_COUNTS


class Reading(_OfCounts):
    """Count of one infra-red sensor."""

    kind: Literal["reading"]
    sensor: str

    @property
    def name(self) -> str:
        return self.sensor

    @property
    def sensors_used(self) -> tuple[str, ...]:
        return (self.sensor,)

    def expression(self, counts: Sequence[str]) -> str:
        """Return the count."""
        return counts[0]


class Extreme(_OfCounts):
    """Largest (nearest obstacle) or smallest count among sensors of one heading."""

    kind: Literal["maximum", "minimum"]
    heading: Heading
    sensors: Annotated[tuple[str, ...], Field(min_length=1)]

    @property
    def name(self) -> str:
        return f"{self.kind} {self.heading}"

    @property
    def sensors_used(self) -> tuple[str, ...]:
        return self.sensors

    def expression(self, counts: Sequence[str]) -> str:
        """Return the extreme; max and min of a single number are an error."""
        extreme = "max" if self.kind == "maximum" else "min"
        return counts[0] if len(counts) == 1 else f"{extreme}({', '.join(counts)})"

    def measured(self, names: Mapping[str, str]) -> tuple[object, ...]:
        """Return its kind and the set of its sensors."""
        return self.kind, frozenset(names[sensor] for sensor in self.sensors)


class Orientation(_OfCounts):
    """Difference of two sensors of one heading, 0 if negative: deviation of the wall from parallel."""

    kind: Literal["orientation"]
    heading: Heading
    nearer: str
    farther: str

    @property
    def name(self) -> str:
        return f"orientation {self.heading} {self.nearer}>{self.farther}"

    @property
    def sensors_used(self) -> tuple[str, ...]:
        return self.nearer, self.farther

    def expression(self, counts: Sequence[str]) -> str:
        """Return the difference or 0."""
        nearer, farther = counts
        return f"{nearer} - {farther} if {nearer} > {farther} else 0"


class WheelSpeed(Feature):
    """Set point of one side of the last driven action; constant while the robot waits."""

    kind: Literal["wheel_speed"]
    side: Literal["left", "right"]

    @property
    def name(self) -> str:
        return f"wheel speed {self.side}"

    def expression(self, counts: Sequence[str]) -> str:  # noqa: ARG002 - it has none
        """Return the set point, which is scaled already."""
        return "driven[0]" if self.side == "left" else "driven[1]"

    def measured(self, names: Mapping[str, str]) -> tuple[object, ...]:
        """Return its side."""
        return self.kind, names[self.side]

    def bounds(self, top_speed: int) -> tuple[int, int]:
        """Return the top speed of both directions, at least 1: checkers of Gymnasium warn of equal bounds."""
        return -max(1, top_speed), max(1, top_speed)

    def batch_kind(self, scale: int) -> FeatureKind | None:
        """Return NOTHING for a scale of 0; a batch knows no others."""
        return None if scale else FeatureKind.NOTHING


AnyFeature = Annotated[Reading | Extreme | Orientation | WheelSpeed, Field(discriminator="kind")]


class SituationDefinition(Settings):
    """Names and order of the features: n values of now, then their n averages (paper, section VI.B.1).

    A file of `config/situations` holds it. `history_steps` is the window of the averages in ticks, 1000 for 10 s.
    Knowledge fits one definition only: its `hash` is stored with the lessons, and another one is refused.
    """

    name: str
    history_steps: Annotated[int, Field(ge=1, le=100_000)]
    features: Annotated[tuple[AnyFeature, ...], Field(min_length=1)]
    wheel_speed_counts_per_m_s: Annotated[int, Field(ge=0, le=1000)]
    """Scale of the wheel-speed features; 0 removes them from all distances."""

    @property
    def dimensions(self) -> int:
        """Length of a situation vector: number of recent and of averaged values together."""
        return 2 * len(self.features)

    @property
    def names(self) -> tuple[str, ...]:
        """Name of each dimension, as shown to the teacher: recent values first, then their averages."""
        recent = tuple(feature.name for feature in self.features)
        return recent + tuple(name + AVERAGED for name in recent)

    @property
    def sensors_used(self) -> frozenset[str]:
        """Names of all sensors that features read."""
        return frozenset(name for feature in self.features for name in feature.sensors_used)

    def hash(self, sensors: tuple[str, ...], kind: str) -> str:
        """Return the fingerprint of definition, sensor order and kind of robot; other knowledge is refused."""
        content = {"definition": self.model_dump(mode="json"), "sensors": list(sensors), "kind": kind}
        return fingerprint(content)


def load_situation(name_or_path: str, sensors: tuple[str, ...]) -> SituationDefinition:
    """Return the definition of a built-in name or a path, for a robot with these sensors.

    Raises config.settings.SettingsError: for a missing or invalid file, and for a feature of an unknown sensor.
    """
    path = find_config("situations", name_or_path)
    definition = load_settings(path, SituationDefinition)
    missing = sorted(definition.sensors_used - set(sensors))
    if missing:
        raise SettingsError(
            f"features: the robot has no sensor {', '.join(missing)}",
            where=path,
            do=f"allowed: {', '.join(sensors)}{guess(missing[0], sensors)}",
        )
    return definition


def feature_weights(
    definition: SituationDefinition, changed: Iterable[tuple[Iterable[str], float]], history_weight: float, task: str
) -> NDArray[np.float64]:
    """Return the weights, shape (d,): 1 for recent features except `changed` ones, times `history_weight` for averages.

    Raises SettingsError, with the name of the `task`, for an unknown feature, for one with two weights, and if all
    weights are 0.
    """
    names = [feature.name for feature in definition.features]
    recent = dict.fromkeys(names, 1.0)
    seen: set[str] = set()
    for place, (features, weight) in enumerate(changed):
        key = f"task {task}: learning.weights.{place}.features"
        for name in features:
            if name not in recent:
                raise SettingsError(
                    f"situation {definition.name} has no feature {name!r}", where=key, do=f"it has: {', '.join(names)}"
                )
            if name in seen:
                raise SettingsError(f"{name!r} is given two weights", where=key, do="leave one out")
            seen.add(name)
            recent[name] = weight
    if not any(recent.values()):
        raise SettingsError("learning.weights: every feature weighs 0", where=f"task {task}", do="leave one with more")
    values = np.array([recent[name] for name in names])
    return np.concatenate((values, history_weight * values))
