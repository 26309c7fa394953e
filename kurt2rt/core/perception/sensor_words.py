"""Words for features: sensors by their places, readings in centimetres."""

import re
from collections.abc import Mapping
from typing import NamedTuple

from hal.robot_settings import InfraredSettings
from kurt2rt.core.perception.definition import AVERAGED

_NEAR_NOISE = 4
"""Standard deviations above the floor within which a reading is noise."""
_EXTREME = re.compile(r"(maximum|minimum) (\w+)")
_WHERE = {"front": "in front", "rear": "behind", "left": "on the left", "right": "on the right"}
_ORIENTATION = re.compile(r"orientation \w+ (\w+)>(\w+)")


class InfraredLaw(NamedTuple):
    """Inverse law of the infra-red sensors: distance = numerator / (counts + bias) - offset, from near to far."""

    numerator_counts_m: float
    offset_m: float
    bias_counts: float
    near_m: float
    far_m: float
    nothing_counts: float
    """Readings up to here are noise: the sensor sees nothing."""

    def detects(self, counts: float) -> bool:
        """Return whether a reading stands for anything but noise."""
        return counts > self.nothing_counts

    def distance_m(self, counts: float) -> float:
        """Return the distance from the sensor's face that a reading stands for, near_m to far_m."""
        if not self.detects(counts):
            return self.far_m
        return min(self.far_m, max(self.near_m, self.numerator_counts_m / (counts + self.bias_counts) - self.offset_m))


def infrared_law(infrared: InfraredSettings) -> InfraredLaw:
    """Return the inverse law of a robot's sensors."""
    return InfraredLaw(
        infrared.numerator_counts_m,
        infrared.offset_m,
        infrared.bias_counts,
        infrared.near_m,
        infrared.far_m,
        infrared.floor_counts + _NEAR_NOISE * infrared.noise_least_counts,
    )


class SensorWords:
    """Words for the features of a situation, by the names of the situation's definition."""

    def __init__(self, labels: Mapping[str, str], law: InfraredLaw | None) -> None:
        """`labels`: the sensors' places by their names, such as `front left`; `law`: None where it is not known."""
        self._labels = labels
        self._law = law

    def place(self, feature: str) -> str:
        """Return the feature's place, such as `front left`; a name that is not known stays as it is."""
        if not self._labels:
            return feature
        recent = feature.removesuffix(AVERAGED)
        if extreme := _EXTREME.fullmatch(recent):
            place = f"{'nearest' if extreme[1] == 'maximum' else 'farthest'} {_WHERE.get(extreme[2], extreme[2])}"
        elif turned := _ORIENTATION.fullmatch(recent):
            place = f"{self._label(turned[1])} nearer than {self._label(turned[2])}"
        else:
            place = self._label(recent)
        return place if recent == feature else f"{place}{AVERAGED}"

    def reading(self, feature: str, value: float) -> str:
        """Return the feature's value: centimetres for a reading, otherwise the number.

        How much nearer one sensor is than another is told in counts: it is no distance.
        """
        if self._labels and _ORIENTATION.fullmatch(feature.removesuffix(AVERAGED)):
            return f"by {value:.0f} counts" if round(value) else "not"
        if self._law is None or not self.is_reading(feature):
            return f"{value:.0f}" if abs(value) >= 10 else f"{value:.2f}".rstrip("0").rstrip(".")
        if not self._law.detects(value):
            return f"nothing within {_centimetres(self._law.far_m)}"
        distance_m = self._law.distance_m(value)
        return f"{_centimetres(distance_m)}{' or less' if distance_m <= self._law.near_m else ''}"

    def difference(self, feature: str, here: float, there: float) -> str:
        """Return what the feature is and what it was taught as, such as `front left: 13 cm, was 40 cm`."""
        return f"{self.place(feature)}: {self.reading(feature, here)}, was {self.reading(feature, there)}"

    def differs(self, feature: str, here: float, there: float) -> bool:
        """Return whether the two values read differently: readings of the same whole centimetre do not."""
        return self.reading(feature, here) != self.reading(feature, there)

    def is_reading(self, feature: str) -> bool:
        """Return whether the feature is a sensor's reading, or the nearest or farthest of some."""
        recent = feature.removesuffix(AVERAGED)
        return recent in self._labels or _EXTREME.fullmatch(recent) is not None

    def _label(self, sensor: str) -> str:
        return self._labels.get(sensor, sensor)


NO_WORDS = SensorWords({}, None)
"""For sensors that are not known: names and numbers stay as they are."""


def words_for(infrared: InfraredSettings) -> SensorWords:
    """Return the words for a robot's sensors."""
    return SensorWords({each.name: each.label for each in infrared.sensors}, infrared_law(infrared))


def _centimetres(distance_m: float) -> str:
    return f"{round(distance_m * 100)} cm"
