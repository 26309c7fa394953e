"""Sides of a robot for the critic, by the headings of its range sensors."""

import math

from behaviors.policies.sectors import ahead_first
from hal.robot_settings import InfraredSettings, RobotSettings, SensorSettings
from kurt2rt.core.critic.settings import CriticSettings, SideSensors, load_critic

_SIDES_DEG = {"front": 0.0, "ahead_left": 45.0, "left": 90.0, "rear": 180.0, "right": -90.0, "ahead_right": -45.0}
_HALF_WIDTH_DEG = 22.5
_FEWEST = {"left": 2, "right": 2}


def critic_of(critic: str | CriticSettings, robot: RobotSettings) -> CriticSettings:
    """Return the critic of a task for a robot, with the sensors of each side by name.

    Sectors take the robot's sensors that look into them. The sides of a shipped critic are those of KURT2's sensors: a
    robot without these takes the sensors whose headings fit best. Raises config.settings.SettingsError.
    """
    settings = load_critic(critic)
    wanted, infrared = settings.perception, robot.infrared
    named = wanted.sensors
    if named is not None and (isinstance(critic, CriticSettings) or named.used <= set(infrared.names)):
        return settings
    sensors = sides_of(infrared) if wanted.sectors is None else wanted.sectors.sensors_of(infrared)
    perception = wanted.model_copy(update={"sensors": sensors, "sectors": None})
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
    return tuple(sensor.name for sensor in sorted(found, key=ahead_first))
