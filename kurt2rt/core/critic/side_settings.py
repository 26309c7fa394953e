"""Schema of the sides of a critic: sensors by name, or sectors of headings."""

from typing import Annotated

from pydantic import Field

from behaviors.policies.sectors import Sector
from hal.robot_settings import InfraredSettings
from hal.settings import Settings

Sensors = Annotated[tuple[str, ...], Field(min_length=1)]


class SideSensors(Settings):
    """Sensors of each side; left and right from front to back."""

    left: Sensors
    right: Sensors
    front: Sensors
    rear: Sensors
    ahead_left: Sensors
    ahead_right: Sensors
    wall: Sensors
    """Sensors for the feature no_wall."""

    @property
    def used(self) -> frozenset[str]:
        """Names of all sensors."""
        return frozenset(name for names in self.model_dump().values() for name in names)


class SideSectors(Settings):
    """Sector of each side; a sensor may look into several."""

    left: Sector
    right: Sector
    front: Sector
    rear: Sector
    ahead_left: Sector
    ahead_right: Sector
    wall: Sector
    """Sector for the feature no_wall."""

    def sensors_of(self, infrared: InfraredSettings) -> SideSensors:
        """Return the sensors of each side, from front to back.

        Raises hal.settings.SettingsError that names the side for a sector into which no sensor looks.
        """
        return SideSensors(
            **{side: getattr(self, side).sensors_of(infrared, f"critic: {side}") for side in SideSensors.model_fields}
        )
