"""Fleeing with collision avoidance, for any robot with range sensors ahead."""

from behaviors.policies.policy import PolicySettings, ReferencePolicy
from behaviors.policies.sectors import Metres, Sector
from hal.robot_settings import InfraredSettings


class SectorFleeingSettings(PolicySettings):
    """Sectors and thresholds."""

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
        """Return a policy with these thresholds. Raises hal.settings.SettingsError for a sector without a sensor."""
        return SectorFleeing(self, infrared)


class SectorFleeing:
    """Spin left from near obstacles, curve away from the others: the policy `fleeing` over sectors."""

    def __init__(self, settings: SectorFleeingSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        self._front_m = settings.front.nearest(infrared)
        self._left_m, self._right_m = settings.left.nearest(infrared), settings.right.nearest(infrared)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Return the name of the action for the counts of all sensors; `behaviour` is not used."""
        want, left_m, right_m = self._settings, self._left_m(infrared_counts), self._right_m(infrared_counts)
        edge_m = min(left_m, right_m)
        if self._front_m(infrared_counts) < want.front_m or edge_m < want.edge_m:
            return "whirl_left"
        if edge_m < want.wary_m:
            return "curve_left" if right_m <= left_m else "curve_right"
        return "flee"
