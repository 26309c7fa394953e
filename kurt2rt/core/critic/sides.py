"""Sides of a robot for the critic, by the headings of its range sensors."""

import math

from hal.robot_settings import InfraredSettings, RobotSettings, SensorSettings
from kurt2rt.core.critic.settings import CriticSettings, SideSensors, load_critic

_SIDES_DEG = {"front": 0.0, "ahead_left": 45.0, "left": 90.0, "rear": 180.0, "right": -90.0, "ahead_right": -45.0}
_HALF_WIDTH_DEG = 22.5
_FEWEST = {"left": 2, "right": 2}


def critic_of(critic: str | CriticSettings, robot: RobotSettings) -> CriticSettings:
    """Return the critic of a task for a robot.

    The sides of a shipped critic are those of KURT2's sensors. For a robot without them they go by the headings of its
    sensors. Raises hal.settings.SettingsError.
    """
    settings = load_critic(critic)
    if isinstance(critic, CriticSettings) or settings.perception.sensors.used <= set(robot.infrared.names):
        return settings
    perception = settings.perception.model_copy(update={"sensors": sides_of(robot.infrared)})
    return settings.model_copy(update={"perception": perception})


def sides_of(infrared: InfraredSettings) -> SideSensors:
    """Return the sensors of each side: those that look there, or else the ones whose headings are nearest to it."""
    sides = {side: _sensors_at(infrared, heading_deg, _FEWEST.get(side, 1)) for side, heading_deg in _SIDES_DEG.items()}
    return SideSensors(**sides, wall=tuple(dict.fromkeys((*sides["left"], *sides["ahead_left"]))))


def _sensors_at(infrared: InfraredSettings, heading_deg: float, fewest: int) -> tuple[str, ...]:
    """Return names of sensors from front to back."""

    def away_deg(sensor: SensorSettings) -> float:
        return abs(math.remainder(sensor.heading_deg - heading_deg, 360.0))

    nearest = sorted(infrared.sensors, key=lambda sensor: (away_deg(sensor), sensor.name))
    looking = [sensor for sensor in nearest if away_deg(sensor) <= _HALF_WIDTH_DEG]
    found = looking if len(looking) >= fewest else nearest[:fewest]
    ahead_first = sorted(found, key=lambda sensor: (-sensor.x_m, abs(sensor.heading_deg), sensor.name))
    return tuple(sensor.name for sensor in ahead_first)
