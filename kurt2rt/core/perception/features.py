"""Recent features of a situation: raw readings, extremes per heading, orientation to walls, wheel speeds."""

from collections.abc import Callable, Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from hal.robot import WheelSpeeds
from kurt2rt.core.perception.definition import Extreme, Feature, Orientation, Reading, SituationDefinition, WheelSpeed

Counts = tuple[int, ...]


class FeatureExtractor:
    """Function from sensor counts to the features of a definition, as integers (paper, section VI.B.1)."""

    def __init__(self, definition: SituationDefinition, sensors: tuple[str, ...]) -> None:
        place = {name: index for index, name in enumerate(sensors)}
        scale = definition.wheel_speed_counts_per_m_s
        # One compiled expression of indexes and a scale takes a third of the time of one call per feature, each tick.
        expressions = ", ".join(_expression(feature, place, scale) for feature in definition.features)
        self._values: Callable[[Counts, WheelSpeeds], tuple[int, ...]] = eval(
            f"lambda counts, driven: ({expressions},)"
        )

    def __call__(self, counts: Counts, driven: WheelSpeeds) -> NDArray[np.int64]:
        """Return the features, shape (number of features,), of sensor counts and the last driven set points in m/s."""
        return np.array(self._values(counts, driven), dtype=np.int64)


def _expression(feature: Feature, place: Mapping[str, int], scale: int) -> str:
    """Return a feature as a Python expression of `counts` and `driven`."""
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
