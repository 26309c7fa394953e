"""Wall following with the wall on the left."""

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
    """Thresholds; distances from the sensors' faces."""

    wanted_m: Distance
    """Set distance to the wall on the left."""
    tolerance_m: Annotated[float, Field(gt=0, le=0.2)]
    """Dead band round the set distance."""
    front_m: Distance
    """Distance ahead below which the robot spins right."""
    edge_m: Distance
    """Distance at the front left edge below which the robot spins right."""
    corner_m: Distance
    """Distance at the front left edge above which a corner is passed."""
    bay_m: Distance
    """Distance at the front right edge below which a curve does not fit at the end of the wall."""
    lost_m: Distance
    """Distance above which a wall is lost."""
    heading_weight_m: Annotated[float, Field(ge=0, le=1)]
    """Distance error in m per radian of heading error."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """Return a policy with these thresholds. Raises KeyError if the robot lacks one of its sensors."""
        return WallFollowing(self, infrared)


class WallFollowing:
    """Spin right at an obstacle ahead, curve left at the end of the wall, else hold distance and heading."""

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
        """Return the name of the action for the counts of all sensors; `behaviour` is not used."""
        want = self._settings
        left = self._left(infrared_counts)
        left_edge, right_edge = self._edges(infrared_counts)
        front = min(self._front(infrared_counts))
        if front < want.front_m or left_edge < want.edge_m or min(left) <= self._near_m:
            return "spin_right"
        if left[0] > want.lost_m:  # no wall next to the nose
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
