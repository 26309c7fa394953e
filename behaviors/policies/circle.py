"""Counter-clockwise circle round an object smaller than the gap between two sensors."""

from typing import NamedTuple

from behaviors.policies.distances import LEFT_FRONT_TO_BACK, Distance, Distances
from behaviors.policies.policy import PolicySettings, ReferencePolicy
from hal.robot_settings import InfraredSettings


class CircleSettings(PolicySettings):
    """Thresholds of the policy that circles round a post; distances in m from the sensors' faces."""

    near_m: Distance
    """Distance to the object on the left below which the robot drives straight on."""
    far_m: Distance
    """Distance above which the robot narrows the curve earlier."""
    lost_m: Distance
    """Distance on the left above which an object counts as not seen."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """Return a policy with these thresholds. Raises KeyError if the robot lacks one of its sensors."""
        return Circle(self, infrared)


class Thresholds(NamedTuple):
    """Thresholds of `CircleSettings` in m as plain numbers, for `choose_action`; a batch compiles both."""

    near_m: float
    far_m: float
    lost_m: float


Side = tuple[float, float, float, float]
"""Distances in m of the sensors on the left, from front to back."""

ACTIONS = ("spin_left", "forward", "bear_left", "curve_left")
_SPIN_LEFT, _FORWARD, _BEAR_LEFT, _CURVE_LEFT = range(4)


def choose_action(left: Side, want: Thresholds) -> int:
    """Return the index in ACTIONS of the action that circles round a post on the left; a batch compiles it.

    `left`: distances in m of the sensors on the left, from front to back.
    """
    nearest_m = min(left)
    if nearest_m >= want.lost_m:
        return _SPIN_LEFT
    if nearest_m < want.near_m:
        return _FORWARD
    ahead_m = left[0] if nearest_m > want.far_m else min(left[0], left[1])
    return _BEAR_LEFT if ahead_m <= nearest_m else _CURVE_LEFT


class Circle:
    """Policy that circles round a post on the left: curve left, less while it is ahead of abeam, else spin left.

    Not for places with walls in range: the robot would follow a wall, and the policy ignores the front sensors.
    """

    actions = ACTIONS

    def __init__(self, settings: CircleSettings, infrared: InfraredSettings) -> None:
        self.thresholds = Thresholds(settings.near_m, settings.far_m, settings.lost_m)
        self._left = Distances(infrared).of(*LEFT_FRONT_TO_BACK)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Return the name of the action for the counts of all sensors; `behaviour` is not used."""
        front, mid_1, mid_2, back = self._left(infrared_counts)
        return ACTIONS[choose_action((front, mid_1, mid_2, back), self.thresholds)]
