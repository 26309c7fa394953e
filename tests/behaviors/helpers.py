"""What the robot senses in a test: distances become counts by the sensors' own law."""

from hal.robot import SensorReadings
from hal.robot_settings import RobotSettings, load_robot

ROBOT: RobotSettings = load_robot()
SENSORS = ROBOT.infrared.names


def counts(nothing_nearer_than_m: float = 0.6, **distances_m: float) -> tuple[int, ...]:
    """Counts of a robot that sees walls at these distances from the faces of the named sensors, else nothing."""
    return tuple(round(ROBOT.infrared.counts_at(distances_m.get(name, nothing_nearer_than_m))) for name in SENSORS)


def sensed(
    infrared_counts: tuple[int, ...] = (70,) * len(SENSORS), *, left_ticks: int = 0, right_ticks: int = 0
) -> SensorReadings:
    return SensorReadings(0.0, infrared_counts, 0.0, left_ticks, right_ticks, 0.0, 0, 0.0)
