"""Wall following with the wall on the left: what the scripted teacher of that task says."""

from typing import Annotated

from pydantic import Field

from behaviors.policies.distances import (
    FRONT,
    FRONT_LEFT_EDGE,
    FRONT_RIGHT_EDGE,
    LEFT_FRONT_TO_BACK,
    Distance,
    Distances,
)
from behaviors.policies.policy import PolicySettings, ReferencePolicy
from hal.robot_settings import InfraredSettings


class WallFollowingSettings(PolicySettings):
    """What the teacher looks for; distances from the sensor's face."""

    wanted_m: Distance
    """Distance to the wall on the left."""
    tolerance_m: Annotated[float, Field(gt=0, le=0.2)]
    """Dead band round it in which the robot drives straight on."""
    front_m: Distance
    """An obstacle ahead nearer than this makes the robot turn right on the spot."""
    edge_m: Distance
    """The same for the sensor that looks ahead to the left."""
    corner_m: Distance
    """A corner that this sensor sees nearer than this is not curved round yet."""
    bay_m: Distance
    """Something to the right ahead nearer than this, where the wall on the left ends: too narrow for a curve."""
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
        distances = Distances(infrared)
        self._front = distances.of(*FRONT)
        self._edges = distances.of(FRONT_LEFT_EDGE, FRONT_RIGHT_EDGE)
        self._left = distances.of(*LEFT_FRONT_TO_BACK)
        front_m, *_, back_m = distances.ahead_m(*LEFT_FRONT_TO_BACK)
        self._baseline_m = front_m - back_m

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Name of the action."""
        want = self._settings
        left = self._left(infrared_counts)
        left_edge, right_edge = self._edges(infrared_counts)
        front = min(self._front(infrared_counts))
        if front < want.front_m or left_edge < want.edge_m or min(left) <= self._near_m:
            return "spin_right"
        if left[0] > want.lost_m:  # the wall ends beside the nose, or is gone
            past_corner = left_edge > want.corner_m
            if past_corner and right_edge < want.bay_m:
                return "spin_left"
            return "curve_left" if past_corner and max(left[1], left[3]) > want.lost_m else "forward"
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
