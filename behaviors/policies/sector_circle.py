"""Counter-clockwise circle round a post or column, for any robot with range sensors ahead and ahead to the left."""

from behaviors.policies.policy import PolicySettings, ReferencePolicy
from behaviors.policies.sector_policy import SectorPolicy
from behaviors.policies.sectors import Metres, Sector
from hal.robot_settings import InfraredSettings


class SectorCircleSettings(PolicySettings):
    """Sectors and thresholds of the policy that circles round a post."""

    chooses_among = ("spin_right", "curve_right", "forward", "sharp_left")

    front: Sector
    left: Sector
    """Sector in which the post appears before it is abeam."""
    front_m: Metres
    """Distance in front below which the robot spins right."""
    near_m: Metres
    """Distance in the left sector below which the robot curves right."""
    far_m: Metres
    """Distance in the left sector below which the robot drives straight on; above it turns sharply left."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """Return a policy with these thresholds. Raises config.settings.SettingsError for a sector without a sensor."""
        return SectorCircle(self, infrared)


class SectorCircle(SectorPolicy[SectorCircleSettings]):
    """Policy that circles round a post: a sharp curve left until the post appears ahead, then past it.

    A post that is abeam need not be seen. The curve has to be narrower than the circle, so that it leads back to the
    post.
    """

    blocked = "spin_right"

    def _way_on(self, left_m: float, infrared_counts: tuple[int, ...]) -> str:  # noqa: ARG002
        want = self._settings
        if left_m < want.near_m:
            return "curve_right"
        return "forward" if left_m < want.far_m else "sharp_left"
