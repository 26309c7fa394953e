"""Fleeing with collision avoidance."""

from behaviors.policies.distances import FRONT, FRONT_LEFT_EDGE, FRONT_RIGHT_EDGE, Distance, Distances
from behaviors.policies.policy import PolicySettings, ReferencePolicy
from hal.robot_settings import InfraredSettings


class FleeingSettings(PolicySettings):
    """Thresholds; distances from the sensors' faces."""

    front_m: Distance
    """Distance ahead below which the robot turns on the spot."""
    edge_m: Distance
    """Distance at the front edges below which the robot turns on the spot."""
    wary_m: Distance
    """Distance at the front edges below which the robot curves away."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """Return a policy with these thresholds. Raises KeyError if the robot lacks one of its sensors."""
        return Fleeing(self, infrared)


class Fleeing:
    """Spin left from near obstacles: neighbouring RLAs that spin to either side would oscillate for ever."""

    def __init__(self, settings: FleeingSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        distances = Distances(infrared)
        self._front = distances.of(*FRONT)
        self._edges = distances.of(FRONT_LEFT_EDGE, FRONT_RIGHT_EDGE)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Return the name of the action for the counts of all sensors; `behaviour` is not used."""
        want = self._settings
        left, right = self._edges(infrared_counts)
        if min(self._front(infrared_counts)) < want.front_m or min(left, right) < want.edge_m:
            return "whirl_left"
        if min(left, right) < want.wary_m:
            return "curve_left" if right <= left else "curve_right"
        return "flee"
