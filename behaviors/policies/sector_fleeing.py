"""Fleeing with collision avoidance, for any robot with range sensors ahead."""

from behaviors.policies.policy import PolicySettings, ReferencePolicy
from behaviors.policies.sector_policy import SectorPolicy
from behaviors.policies.sectors import Metres, Sector
from hal.robot_settings import InfraredSettings


class SectorFleeingSettings(PolicySettings):
    """Sectors and thresholds of the policy that flees from walls."""

    chooses_among = ("whirl_left", "curve_left", "curve_right", "flee")

    front: Sector
    left: Sector
    right: Sector
    front_m: Metres
    """Distance in front below which the robot turns on the spot."""
    edge_m: Metres
    """Distance on the left or the right below which the robot turns on the spot."""
    wary_m: Metres
    """Distance on the left or the right below which the robot curves away."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """Return a policy with these thresholds. Raises config.settings.SettingsError for a sector without a sensor."""
        return SectorFleeing(self, infrared)


class SectorFleeing(SectorPolicy[SectorFleeingSettings]):
    """Policy `fleeing` over sectors: spin left from near obstacles, curve away from the others."""

    blocked = "whirl_left"

    def __init__(self, settings: SectorFleeingSettings, infrared: InfraredSettings) -> None:
        super().__init__(settings, infrared)
        self._right_m = settings.right.nearest(infrared)

    def _way_on(self, left_m: float, infrared_counts: tuple[int, ...]) -> str:
        want, right_m = self._settings, self._right_m(infrared_counts)
        edge_m = min(left_m, right_m)
        if edge_m < want.edge_m:
            return self.blocked
        if edge_m < want.wary_m:
            return "curve_left" if right_m <= left_m else "curve_right"
        return "flee"
