"""Recent features of a situation: raw readings, extremes per heading, orientation to walls, wheel speeds."""

from collections.abc import Callable, Mapping

from hal.robot import WheelSpeeds
from kurt2rt.core.perception.definition import Extreme, Feature, Orientation, Reading, SituationDefinition, WheelSpeed

Counts = tuple[int, ...]


class FeatureExtractor:
    """Function from sensor counts to the features of a definition, as integers (paper, section VI.B.1)."""

    def __init__(self, definition: SituationDefinition, sensors: tuple[str, ...]) -> None:
        place = {name: index for index, name in enumerate(sensors)}
        scale = definition.wheel_speed_counts_per_m_s
        # One compiled expression takes a third of the time of one call per feature, each tick.
        parameters = ", ".join(f"c{index}" for index in range(len(sensors)))
        expressions = ", ".join(_expression(feature, place, scale) for feature in definition.features)
        self._values: Callable[..., tuple[int, ...]] = eval(f"lambda driven, {parameters}: ({expressions},)")

    def __call__(self, counts: Counts, driven: WheelSpeeds) -> tuple[int, ...]:
        """Return the features of sensor counts, one per sensor, and of the last driven set points in m/s."""
        return self._values(driven, *counts)


def _expression(feature: Feature, place: Mapping[str, int], scale: int) -> str:
    """Return a feature as a Python expression of `driven` and the counts of sensors, `c0` of the first."""
    match feature:
        case Reading():
            return f"c{place[feature.sensor]}"
        case Extreme():
            if len(feature.sensors) == 1:  # max and min of a single number are an error
                return f"c{place[feature.sensors[0]]}"
            extreme = "max" if feature.kind == "maximum" else "min"
            return f"{extreme}({', '.join(f'c{place[name]}' for name in feature.sensors)})"
        case Orientation():
            nearer, farther = f"c{place[feature.nearer]}", f"c{place[feature.farther]}"
            return f"{nearer} - {farther} if {nearer} > {farther} else 0"
        case WheelSpeed():
            side = 0 if feature.side == "left" else 1
            return f"round(driven[{side}] * {scale})" if scale else "0"
