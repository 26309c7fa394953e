"""Counter-clockwise circle round a post or column, for any robot with range sensors ahead and ahead to the left."""

from behaviors.policies.policy import PolicySettings, ReferencePolicy
from behaviors.policies.sectors import Metres, Sector
from hal.robot_settings import InfraredSettings


class SectorCircleSettings(PolicySettings):
    """Sectors and thresholds."""

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
        """Return a policy with these thresholds. Raises hal.settings.SettingsError for a sector without a sensor."""
        return SectorCircle(self, infrared)


class SectorCircle:
    """Turn sharply left until the post appears ahead, then pass it; a post that is abeam need not be seen.

    The curve has to be narrower than the circle, so that it leads back to the post.
    """

    def __init__(self, settings: SectorCircleSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        self._front_m, self._left_m = settings.front.nearest(infrared), settings.left.nearest(infrared)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Return the name of the action for the counts of all sensors; `behaviour` is not used."""
        want, left_m = self._settings, self._left_m(infrared_counts)
        if self._front_m(infrared_counts) < want.front_m:
            return "spin_right"
        if left_m < want.near_m:
            return "curve_right"
        return "forward" if left_m < want.far_m else "sharp_left"
