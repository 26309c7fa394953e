"""Sectors of headings round a robot, so that policies and critics fit any robot with range sensors there."""

from collections.abc import Callable
from typing import Annotated

from pydantic import Field

from behaviors.policies.distances import Distances
from config.settings import Settings, SettingsError
from hal.robot_settings import InfraredSettings, SensorSettings

Metres = Annotated[float, Field(gt=0, le=5)]
"""Distance in metres from the sensors' faces."""
Nearest = Callable[[tuple[int, ...]], float]
"""Return the least distance in m of some sensors, from the counts of all sensors."""
Degrees = Annotated[float, Field(ge=-180, le=180)]


class Sector(Settings):
    """Headings from `from_deg` counter-clockwise to `to_deg`, both included; 0 is ahead, 90 to the left."""

    from_deg: Degrees
    to_deg: Degrees

    def covers(self, heading_deg: float) -> bool:
        """Return whether a heading in degrees lies in the sector."""
        return (heading_deg - self.from_deg) % 360.0 <= (self.to_deg - self.from_deg) % 360.0

    @property
    def mirrored(self) -> "Sector":
        """Sector as in a mirror, which swaps left and right."""
        return Sector(from_deg=-self.to_deg, to_deg=-self.from_deg)

    def sensors_of(self, infrared: InfraredSettings, where: str) -> tuple[str, ...]:
        """Return the names of the sensors that look into the sector, from front to back.

        Raises config.settings.SettingsError that names `where` if the robot has no sensor there.
        """
        found = [sensor for sensor in infrared.sensors if self.covers(sensor.heading_deg)]
        if not found:
            headings = ", ".join(f"{heading:g}" for heading in sorted({each.heading_deg for each in infrared.sensors}))
            raise SettingsError(
                f"no range sensor looks into the sector from {self.from_deg:g} to {self.to_deg:g} degrees",
                where=where,
                do=f"choose a sector with one of the headings {headings}",
            )
        return tuple(sensor.name for sensor in sorted(found, key=ahead_first))

    def nearest(self, infrared: InfraredSettings) -> Nearest:
        """Return the function that finds the least distance in m of the sector's sensors.

        Raises config.settings.SettingsError if the robot has no sensor there.
        """
        distances_m = Distances(infrared).of(*self.sensors_of(infrared, "policy"))
        return lambda counts: min(distances_m(counts))


def ahead_first(sensor: SensorSettings) -> tuple[float, float, str]:
    """Return the key that sorts sensors from front to back."""
    return -sensor.x_m, abs(sensor.heading_deg), sensor.name
