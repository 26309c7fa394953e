"""Wall following with the wall on the left, for any robot with range sensors ahead and ahead to the left."""

from typing import Annotated

from pydantic import Field

from behaviors.policies.policy import PolicySettings, ReferencePolicy
from behaviors.policies.sector_policy import SectorPolicy
from behaviors.policies.sectors import Metres, Sector
from hal.robot_settings import InfraredSettings


class SectorWallFollowingSettings(PolicySettings):
    """Sectors and thresholds."""

    chooses_among = ("spin_right", "curve_left", "curve_right", "bear_left", "bear_right", "forward")

    front: Sector
    left: Sector
    """Sector that sees the wall before the robot is next to it, so that its distance tells the heading, too."""
    wanted_m: Metres
    """Set distance in the left sector."""
    tolerance_m: Annotated[float, Field(gt=0, le=0.5)]
    """Dead band round the set distance."""
    front_m: Metres
    """Distance in front below which the robot spins right."""
    lost_m: Metres
    """Distance in the left sector above which the wall has ended, and the robot curves left."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """Return a policy with these thresholds. Raises hal.settings.SettingsError for a sector without a sensor."""
        return SectorWallFollowing(self, infrared)


class SectorWallFollowing(SectorPolicy[SectorWallFollowingSettings]):
    """Spin right at an obstacle ahead, curve left where the wall ends, else hold the distance ahead to the left."""

    blocked = "spin_right"

    def _way_on(self, left_m: float, infrared_counts: tuple[int, ...]) -> str:  # noqa: ARG002
        want = self._settings
        if left_m > want.lost_m:
            return "curve_left"
        error_m = left_m - want.wanted_m
        if abs(error_m) <= want.tolerance_m:
            return "forward"
        how = "curve" if abs(error_m) > 3 * want.tolerance_m else "bear"
        return f"{how}_left" if error_m > 0 else f"{how}_right"
