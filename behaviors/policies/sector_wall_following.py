"""Wall following with the wall on one side, for any robot with range sensors ahead and ahead to that side."""

from typing import Annotated, get_args

from pydantic import Field

from behaviors.policies.policy import PolicySettings, ReferencePolicy
from behaviors.policies.sectors import Metres, Sector
from hal.robot_settings import InfraredSettings
from hal.simulation import WallSide


class SectorWallFollowingSettings(PolicySettings):
    """Sectors and thresholds of a wall on the left."""

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
        """Return a policy with these thresholds. Raises hal.settings.SettingsError for a sector without a sensor."""
        return SectorWallFollowing(self, infrared)

    @property
    def required_actions(self) -> tuple[str, ...]:
        """Names of the actions that a repertoire needs for a wall on this side."""
        names = super().required_actions
        return names if self.side == "left" else tuple(map(_mirrored, names))


class SectorWallFollowing:
    """Spin right at an obstacle ahead, curve left where the wall ends, else hold the distance ahead to the left."""

    def __init__(self, settings: SectorWallFollowingSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        front, left = settings.front, settings.left
        if settings.side == "right":
            front, left = front.mirrored, left.mirrored
        self._front_m, self._left_m = front.nearest(infrared), left.nearest(infrared)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Return the name of the action for the counts of all sensors; `behaviour` is not used."""
        action = self._with_wall_on_left(infrared_counts)
        return action if self._settings.side == "left" else _mirrored(action)

    def _with_wall_on_left(self, infrared_counts: tuple[int, ...]) -> str:
        want, left_m = self._settings, self._left_m(infrared_counts)
        if self._front_m(infrared_counts) < want.front_m:
            return "spin_right"
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
