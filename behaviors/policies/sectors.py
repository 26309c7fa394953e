"""Sectors of headings round a robot, so that a policy fits any robot with range sensors there."""

from collections.abc import Callable
from typing import Annotated

from pydantic import Field

from behaviors.policies.distances import Distances
from hal.robot_settings import InfraredSettings
from hal.settings import Settings, SettingsError

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

    def nearest(self, infrared: InfraredSettings) -> Nearest:
        """Return the function that finds the least distance in m of the sector's sensors.

        Raises hal.settings.SettingsError if the robot has no sensor there.
        """
        names = [sensor.name for sensor in infrared.sensors if self.covers(sensor.heading_deg)]
        if not names:
            headings = ", ".join(f"{heading:g}" for heading in sorted({each.heading_deg for each in infrared.sensors}))
            raise SettingsError(
                f"no range sensor looks into the sector from {self.from_deg:g} to {self.to_deg:g} degrees",
                where="policy",
                do=f"choose a sector with one of the headings {headings}",
            )
        distances_m = Distances(infrared).of(*names)
        return lambda counts: min(distances_m(counts))
