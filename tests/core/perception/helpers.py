"""A robot with four sensors and a definition small enough to compute by hand."""

import json
from collections.abc import Mapping, Sequence

from hal.robot import SensorReadings
from kurt2rt.core.perception.definition import SituationDefinition

SENSORS = ("a", "b", "c", "d")

READINGS: tuple[Mapping[str, object], ...] = ({"kind": "reading", "sensor": "b"}, {"kind": "reading", "sensor": "a"})
EXTREMES: tuple[Mapping[str, object], ...] = (
    {"kind": "maximum", "heading": "front", "sensors": ["a", "c"]},
    {"kind": "minimum", "heading": "front", "sensors": ["d", "b", "c"]},
    {"kind": "maximum", "heading": "rear", "sensors": ["d"]},
)
ORIENTATIONS: tuple[Mapping[str, object], ...] = (
    {"kind": "orientation", "heading": "left", "nearer": "a", "farther": "b"},
    {"kind": "orientation", "heading": "left", "nearer": "b", "farther": "a"},
)
WHEELS: tuple[Mapping[str, object], ...] = (
    {"kind": "wheel_speed", "side": "right"},
    {"kind": "wheel_speed", "side": "left"},
)
ALL_KINDS = (*READINGS, *EXTREMES, *ORIENTATIONS, *WHEELS)


def definition(
    features: Sequence[Mapping[str, object]] = ALL_KINDS, *, history_steps: int = 4, scale: int = 100
) -> SituationDefinition:
    content = {
        "name": "small",
        "history_steps": history_steps,
        "features": list(features),
        "wheel_speed_counts_per_m_s": scale,
    }
    return SituationDefinition.model_validate_json(json.dumps(content))


def sensed(*counts: int) -> SensorReadings:
    return SensorReadings(0.0, counts, 0.0, 0, 0, 0.0, 0, 0.0)
