"""The recent half of a situation: raw readings, extremes per heading, orientation to walls, wheel speeds."""

from collections.abc import Callable
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

from hal.robot import WheelSpeeds
from kurt2rt.perception.definition import Extreme, Feature, Orientation, Reading, SituationDefinition, WheelSpeed

Counts = tuple[int, ...]
FeatureFunction = Callable[[Counts, WheelSpeeds], int]


class FeatureExtractor:
    """Computes the features of one definition, in its order, as integers (paper, VI.B.1)."""

    def __init__(self, definition: SituationDefinition, sensors: tuple[str, ...]) -> None:
        self._definition = definition
        position = {name: index for index, name in enumerate(sensors)}
        leading = 0
        while leading < len(definition.features) and isinstance(definition.features[leading], Reading):
            leading += 1
        # The readings stand first in every definition we know: one call takes them all.
        raw = [position[feature.sensor] for feature in definition.features[:leading] if isinstance(feature, Reading)]
        self._leading = itemgetter(*raw) if len(raw) > 1 else None
        rest = definition.features[leading if self._leading else 0 :]
        self._rest = tuple(self._compile(feature, position) for feature in rest)

    def __call__(self, counts: Counts, driven: WheelSpeeds) -> NDArray[np.int64]:
        """Features of the sensors' `counts` and the set points last driven; shape (number of features,)."""
        values = [function(counts, driven) for function in self._rest]
        if self._leading is not None:
            values[:0] = self._leading(counts)
        return np.array(values, dtype=np.int64)

    def _compile(self, feature: Feature, position: dict[str, int]) -> FeatureFunction:
        match feature:
            case Reading():
                index = position[feature.sensor]
                return lambda counts, _driven: counts[index]
            case Extreme():
                pick = itemgetter(*(position[name] for name in (*feature.sensors, feature.sensors[0])))
                extreme = max if feature.kind == "maximum" else min
                return lambda counts, _driven: extreme(pick(counts))
            case Orientation():
                nearer, farther = position[feature.nearer], position[feature.farther]
                return lambda counts, _driven: (
                    counts[nearer] - counts[farther] if counts[nearer] > counts[farther] else 0
                )
            case WheelSpeed():
                scale = self._definition.wheel_speed_counts_per_m_s
                side = 0 if feature.side == "left" else 1
                return lambda _counts, driven: round(driven[side] * scale)
