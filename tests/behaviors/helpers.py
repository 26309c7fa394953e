"""Sensor readings for tests; distances become counts by the infra-red law."""

from hal.kurt2_settings import Kurt2Settings, load_kurt2
from hal.robot import SensorReadings

ROBOT: Kurt2Settings = load_kurt2()
SENSORS = ROBOT.infrared.names


def counts(nothing_nearer_than_m: float = 0.6, **distances_m: float) -> tuple[int, ...]:
    """Return the counts of walls at these distances from the faces of the named sensors."""
    return tuple(round(ROBOT.infrared.counts_at(distances_m.get(name, nothing_nearer_than_m))) for name in SENSORS)


def sensed(
    infrared_counts: tuple[int, ...] = (70,) * len(SENSORS), *, left_ticks: int = 0, right_ticks: int = 0
) -> SensorReadings:
    return SensorReadings(
        time_s=0.0,
        infrared_counts=infrared_counts,
        infrared_age_s=0.0,
        encoder_left_ticks=left_ticks,
        encoder_right_ticks=right_ticks,
        encoder_age_s=0.0,
        bumpers=0,
        bumper_age_s=0.0,
    )
