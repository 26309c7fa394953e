"""The recent half of a situation: raw readings, extremes per heading, orientation to walls, wheel speeds."""

from collections.abc import Callable, Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from hal.robot import WheelSpeeds
from kurt2rt.core.perception.definition import Extreme, Feature, Orientation, Reading, SituationDefinition, WheelSpeed

Counts = tuple[int, ...]


class FeatureExtractor:
    """Computes the features of one definition, in its order, as integers (paper, VI.B.1)."""

    def __init__(self, definition: SituationDefinition, sensors: tuple[str, ...]) -> None:
        place = {name: index for index, name in enumerate(sensors)}
        scale = definition.wheel_speed_counts_per_m_s
        # Compiled as one expression, in which nothing stands but places and a scale: a call for each feature would
        # take three times as long, and this runs in every tick.
        expressions = ", ".join(_expression(feature, place, scale) for feature in definition.features)
        self._values: Callable[[Counts, WheelSpeeds], tuple[int, ...]] = eval(
            f"lambda counts, driven: ({expressions},)"
        )

    def __call__(self, counts: Counts, driven: WheelSpeeds) -> NDArray[np.int64]:
        """Features of the sensors' `counts` and the set points last driven; shape (number of features,)."""
        return np.array(self._values(counts, driven), dtype=np.int64)


def _expression(feature: Feature, place: Mapping[str, int], scale: int) -> str:
    """A feature in Python, over `counts` and the wheel speeds `driven`."""
    match feature:
        case Reading():
            return f"counts[{place[feature.sensor]}]"
        case Extreme():
            extreme = "max" if feature.kind == "maximum" else "min"
            return f"{extreme}(({_readings(feature.sensors, place)},))"
        case Orientation():
            nearer, farther = place[feature.nearer], place[feature.farther]
            return f"counts[{nearer}] - counts[{farther}] if counts[{nearer}] > counts[{farther}] else 0"
        case WheelSpeed():
            side = 0 if feature.side == "left" else 1
            return f"round(driven[{side}] * {scale})" if scale else "0"


def _readings(sensors: Iterable[str], place: Mapping[str, int]) -> str:
    return ", ".join(f"counts[{place[name]}]" for name in sensors)
