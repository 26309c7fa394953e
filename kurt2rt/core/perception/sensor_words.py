"""Texts for features: sensors by position, readings in centimetres."""

import re
from collections.abc import Mapping
from typing import NamedTuple

from hal.robot_settings import InfraredSettings
from kurt2rt.core.perception.definition import AVERAGED

_NEAR_NOISE = 4
"""Standard deviations above the floor within which a reading is noise."""
_EXTREME = re.compile(r"(maximum|minimum) (\w+)")
_SIDES = {"front": "in front", "rear": "behind", "left": "on the left", "right": "on the right"}
_ORIENTATION = re.compile(r"orientation \w+ (\w+)>(\w+)")


class InfraredLaw(NamedTuple):
    """Inverse law of the infra-red sensors: distance = numerator / (counts + bias) - offset, from near to far."""

    numerator_counts_m: float
    offset_m: float
    bias_counts: float
    near_m: float
    far_m: float
    nothing_counts: float
    """Readings up to this value are noise."""

    def detects(self, counts: float) -> bool:
        """Return whether a reading, in counts, is above the noise."""
        return counts > self.nothing_counts

    def distance_m(self, counts: float) -> float:
        """Return the distance in m from the sensor's face for a reading in counts, near_m to far_m."""
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
    """Words for the features of a situation, such as `front left: 13 cm`, in questions and explanations."""

    def __init__(self, labels: Mapping[str, str], law: InfraredLaw | None) -> None:
        """`labels`: sensor name -> position such as `front left`; `law`: None if unknown."""
        self._labels = labels
        self._law = law

    def place(self, feature: str) -> str:
        """Return the feature's position, such as `front left`; an unknown name is returned unchanged."""
        if not self._labels:
            return feature
        recent = feature.removesuffix(AVERAGED)
        if extreme := _EXTREME.fullmatch(recent):
            place = f"{'nearest' if extreme[1] == 'maximum' else 'farthest'} {_SIDES.get(extreme[2], extreme[2])}"
        elif turned := _ORIENTATION.fullmatch(recent):
            place = f"{self._label(turned[1])} nearer than {self._label(turned[2])}"
        else:
            place = self._label(recent)
        return place if recent == feature else f"{place}{AVERAGED}"

    def reading(self, feature: str, value: float) -> str:
        """Return the text of a feature's value: cm for a reading, counts for an orientation, otherwise the number.

        `value`: in counts for readings and orientations, otherwise in the feature's own unit.
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
        """Return the text of two values of a feature, such as `front left: 13 cm, was 40 cm`.

        Both values are in counts for readings and orientations, otherwise in the feature's own unit.
        """
        return f"{self.place(feature)}: {self.reading(feature, here)}, was {self.reading(feature, there)}"

    def differs(self, feature: str, here: float, there: float) -> bool:
        """Return whether two values of a feature, in counts, have different texts.

        Readings have the same text if they round to the same cm.
        """
        return self.reading(feature, here) != self.reading(feature, there)

    def is_reading(self, feature: str) -> bool:
        """Return whether the feature is a sensor's reading, or the nearest or farthest of some."""
        recent = feature.removesuffix(AVERAGED)
        return recent in self._labels or _EXTREME.fullmatch(recent) is not None

    def _label(self, sensor: str) -> str:
        return self._labels.get(sensor, sensor)


NO_WORDS = SensorWords({}, None)
"""Texts without a robot: names and numbers are unchanged."""


def words_for(infrared: InfraredSettings) -> SensorWords:
    """Return the words for the features of a robot's situations, by the places and the law of its sensors."""
    return SensorWords({each.name: each.label for each in infrared.sensors}, infrared_law(infrared))


def _centimetres(distance_m: float) -> str:
    return f"{round(distance_m * 100)} cm"
