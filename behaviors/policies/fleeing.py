"""Fleeing with collision avoidance."""

from typing import NamedTuple

from behaviors.policies.distances import FRONT, FRONT_LEFT_EDGE, FRONT_RIGHT_EDGE, Distance, Distances
from behaviors.policies.policy import PolicySettings, ReferencePolicy
from hal.robot_settings import InfraredSettings


class FleeingSettings(PolicySettings):
    """Thresholds of the policy that flees from walls; distances in m from the sensors' faces."""

    front_m: Distance
    """Distance ahead below which the robot turns on the spot."""
    edge_m: Distance
    """Distance at the front edges below which the robot turns on the spot."""
    wary_m: Distance
    """Distance at the front edges below which the robot curves away."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """Return a policy with these thresholds. Raises KeyError if the robot lacks one of its sensors."""
        return Fleeing(self, infrared)


class Thresholds(NamedTuple):
    """Thresholds of `FleeingSettings` in m as plain numbers, for `choose_action`; a batch compiles both."""

    front_m: float
    edge_m: float
    wary_m: float


ACTIONS = ("flee", "whirl_left", "curve_left", "curve_right")
_FLEE, _WHIRL_LEFT, _CURVE_LEFT, _CURVE_RIGHT = range(4)


def choose_action(front_m: float, left_m: float, right_m: float, want: Thresholds) -> int:
    """Return the index in ACTIONS of the action that flees from near walls; a batch compiles this function.

    `front_m`: least distance of the sensors in front; `left_m`, `right_m`: of those at the front edges.
    """
    edge_m = min(left_m, right_m)
    if front_m < want.front_m or edge_m < want.edge_m:
        return _WHIRL_LEFT
    if edge_m < want.wary_m:
        return _CURVE_LEFT if right_m <= left_m else _CURVE_RIGHT
    return _FLEE


class Fleeing:
    """Policy that drives away from walls, and spins left from near obstacles.

    It always spins to one side, because neighbouring RLAs that spin to either side would oscillate for ever.
    """

    actions = ACTIONS

    def __init__(self, settings: FleeingSettings, infrared: InfraredSettings) -> None:
        self.thresholds = Thresholds(settings.front_m, settings.edge_m, settings.wary_m)
        distances = Distances(infrared)
        self._front = distances.of(*FRONT)
        self._edges = distances.of(FRONT_LEFT_EDGE, FRONT_RIGHT_EDGE)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Return the name of the action for the counts of all sensors; `behaviour` is not used."""
        left_m, right_m = self._edges(infrared_counts)
        return ACTIONS[choose_action(min(self._front(infrared_counts)), left_m, right_m, self.thresholds)]
