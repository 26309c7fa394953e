"""Wall following with the wall on one side, for any robot with range sensors ahead and ahead to that side."""

from typing import Annotated, get_args

from pydantic import Field

from behaviors.policies.policy import PolicySettings, ReferencePolicy
from behaviors.policies.sector_policy import SectorPolicy
from behaviors.policies.sectors import Metres, Sector
from hal.robot_settings import InfraredSettings
from simbridge.contracts.simulation import WallSide


class SectorWallFollowingSettings(PolicySettings):
    """Sectors and thresholds of wall following, named for a wall on the left; `side` mirrors them."""

    chooses_among = ("spin_right", "curve_left", "curve_right", "bear_left", "bear_right", "forward")

    side: WallSide = "left"
    """Side of the robot on which its wall is; right mirrors sectors and actions."""
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
        """Return a policy with these thresholds. Raises config.settings.SettingsError for a sector without a sensor."""
        return SectorWallFollowing(self, infrared)

    @property
    def required_actions(self) -> tuple[str, ...]:
        """Names of the actions that a repertoire needs for a wall on this side."""
        names = super().required_actions
        return names if self.side == "left" else tuple(map(_mirrored, names))


class SectorWallFollowing(SectorPolicy[SectorWallFollowingSettings]):
    """Policy that follows a wall: spin right at an obstacle ahead, curve left where the wall ends.

    Else it holds the distance ahead to the left. Left and right are exchanged for a wall on the right.
    """

    blocked = "spin_right"

    def __init__(self, settings: SectorWallFollowingSettings, infrared: InfraredSettings) -> None:
        if settings.side == "right":
            mirrored = {"front": settings.front.mirrored, "left": settings.left.mirrored}
            settings = settings.model_copy(update=mirrored)
        super().__init__(settings, infrared)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:
        """Return the name of the action for the counts of all sensors; `behaviour` is not used."""
        action = super().choose(infrared_counts, behaviour)
        return action if self._settings.side == "left" else _mirrored(action)

    def _way_on(self, left_m: float, infrared_counts: tuple[int, ...]) -> str:  # noqa: ARG002
        want = self._settings
        if left_m > want.lost_m:
            return "curve_left"
        error_m = left_m - want.wanted_m
        if abs(error_m) <= want.tolerance_m:
            return "forward"
        how = "curve" if abs(error_m) > 3 * want.tolerance_m else "bear"
        return f"{how}_left" if error_m > 0 else f"{how}_right"


def _mirrored(action: str) -> str:
    """Return the name of an action with the sides swapped."""
    name, _, side = action.rpartition("_")
    return f"{name}_{'right' if side == 'left' else 'left'}" if side in get_args(WallSide) else action
