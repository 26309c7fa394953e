"""Wall following with the wall on the left: what the scripted teacher of that task says."""

from operator import itemgetter
from typing import Annotated, Literal

from pydantic import Field

from behaviors.policies.policy import PolicySettings, ReferencePolicy
from hal.robot import HIGHEST_COUNTS
from hal.robot_settings import InfraredSettings

Distance = Annotated[float, Field(ge=0.05, le=0.6)]


class WallFollowingSettings(PolicySettings):
    """What the teacher looks for; distances from the sensor's face."""

    kind: Literal["wall_following"]
    wanted_m: Distance
    """Distance to the wall on the left."""
    tolerance_m: Annotated[float, Field(gt=0, le=0.2)]
    """Dead band round it in which the robot drives straight on."""
    front_m: Distance
    """An obstacle ahead nearer than this makes the robot turn right on the spot."""
    edge_m: Distance
    """The same for the sensor that looks ahead to the left."""
    lost_m: Distance
    """A wall farther than this is no longer a wall beside the robot."""
    heading_weight_m: Annotated[float, Field(ge=0, le=1)]
    """Metres of error that one radian of heading error counts for."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """The policy."""
        return WallFollowing(self, infrared)


class WallFollowing:
    """Turn right at what is ahead, curve left where the wall ends, else hold distance and heading in a dead band."""

    def __init__(self, settings: WallFollowingSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        self._near_m = infrared.near_m
        # Looked up, for a teacher asks in every tick of a lesson.
        self._distance_m = [infrared.distance_m(counts) for counts in range(HIGHEST_COUNTS + 1)]
        sensors = {name: index for index, name in enumerate(infrared.names)}
        self._front = itemgetter(*(sensors[name] for name in ("s9", "s10", "s11")))
        self._edge = sensors["s15"]
        self._left = itemgetter(*(sensors[name] for name in ("s1", "s3", "s4", "s2")))  # from front to back
        self._baseline_m = infrared.sensors[sensors["s1"]].x_m - infrared.sensors[sensors["s2"]].x_m

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Name of the action."""
        want = self._settings
        distance_m = self._distance_m
        front = distance_m[max(self._front(infrared_counts))]
        edge = distance_m[infrared_counts[self._edge]]
        left = [distance_m[counts] for counts in self._left(infrared_counts)]
        if front < want.front_m or edge < want.edge_m or min(left) <= self._near_m:
            return "spin_right"
        if left[0] > want.lost_m:  # the wall ends beside the nose, or is gone
            return "curve_left" if left[3] > want.lost_m or left[1] > want.lost_m else "forward"
        turned_away = (left[0] - left[3]) / self._baseline_m
        error = min(left) - want.wanted_m + want.heading_weight_m * turned_away
        if error > 3 * want.tolerance_m:
            return "curve_left"
        if error > want.tolerance_m:
            return "bear_left"
        if error < -3 * want.tolerance_m:
            return "curve_right"
        if error < -want.tolerance_m:
            return "bear_right"
        return "forward"
