"""Wall following with the wall on the left."""

from typing import Annotated, NamedTuple

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
    """Thresholds of the policy that follows a wall; distances in m from the sensors' faces."""

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


class Thresholds(NamedTuple):
    """Thresholds of `WallFollowingSettings` for one robot in m, as plain numbers that a batch compiles."""

    wanted_m: float
    tolerance_m: float
    front_m: float
    edge_m: float
    corner_m: float
    bay_m: float
    lost_m: float
    heading_weight_m: float
    near_m: float
    """Distance up to which a sensor reads the same."""
    baseline_m: float
    """Distance between the foremost and the hindmost sensor on the left."""


Side = tuple[float, float, float, float]
"""Distances in m of the sensors on the left, from front to back."""

ACTIONS = ("forward", "spin_right", "spin_left", "curve_left", "curve_right", "bear_left", "bear_right")
_FORWARD, _SPIN_RIGHT, _SPIN_LEFT, _CURVE_LEFT, _CURVE_RIGHT, _BEAR_LEFT, _BEAR_RIGHT = range(7)


def choose_action(front_m: float, left_edge_m: float, right_edge_m: float, left: Side, want: Thresholds) -> int:
    """Return the index in ACTIONS of the action that follows a wall on the left; a batch compiles it.

    `front_m`: least distance of the sensors in front; `left`: distances of those on the left, from front to back.
    """
    nearest_m = min(left)
    if front_m < want.front_m or left_edge_m < want.edge_m or nearest_m <= want.near_m:
        return _SPIN_RIGHT
    if left[0] > want.lost_m:  # no wall next to the nose
        past_corner = left_edge_m > want.corner_m
        if past_corner and right_edge_m < want.bay_m:
            return _SPIN_LEFT
        return _CURVE_LEFT if past_corner and max(left[1], left[3]) > want.lost_m else _FORWARD
    turned_away = (left[0] - left[3]) / want.baseline_m
    error = nearest_m - want.wanted_m + want.heading_weight_m * turned_away
    if error > 3 * want.tolerance_m:
        return _CURVE_LEFT
    if error > want.tolerance_m:
        return _BEAR_LEFT
    if error < -3 * want.tolerance_m:
        return _CURVE_RIGHT
    if error < -want.tolerance_m:
        return _BEAR_RIGHT
    return _FORWARD


class WallFollowing:
    """Policy that follows a wall on the left: spin right at an obstacle ahead, curve left where the wall ends.

    Else it holds distance and heading to the wall.
    """

    actions = ACTIONS

    def __init__(self, settings: WallFollowingSettings, infrared: InfraredSettings) -> None:
        distances = Distances(infrared)
        self._look = distances.of(*FRONT, FRONT_LEFT_EDGE, FRONT_RIGHT_EDGE, *LEFT_FRONT_TO_BACK)
        front_m, *_, back_m = distances.ahead_m(*LEFT_FRONT_TO_BACK)
        self.thresholds = Thresholds(
            **settings.model_dump(exclude={"kind"}), near_m=infrared.near_m, baseline_m=front_m - back_m
        )

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Return the name of the action for the counts of all sensors; `behaviour` is not used."""
        front_1, front_2, front_3, left_edge, right_edge, left_1, mid_1, mid_2, left_2 = self._look(infrared_counts)
        front_m, left = min(front_1, front_2, front_3), (left_1, mid_1, mid_2, left_2)
        return ACTIONS[choose_action(front_m, left_edge, right_edge, left, self.thresholds)]
