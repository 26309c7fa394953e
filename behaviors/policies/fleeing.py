"""Fleeing with collision avoidance: turn away from whatever is near, and be off."""

from behaviors.policies.distances import FRONT, FRONT_LEFT_EDGE, FRONT_RIGHT_EDGE, Distance, Distances
from behaviors.policies.policy import PolicySettings, ReferencePolicy
from hal.robot_settings import InfraredSettings


class FleeingSettings(PolicySettings):
    """What the teacher looks for; distances from the sensor's face."""

    front_m: Distance
    """An obstacle ahead nearer than this makes the robot turn on the spot."""
    edge_m: Distance
    """The same for the sensors that look ahead to the sides."""
    wary_m: Distance
    """What these see nearer than this makes it curve away."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """The policy."""
        return Fleeing(self, infrared)


class Fleeing:
    """Always turns left on the spot: neighbouring RLAs that turn to either side turn the robot to and fro for ever."""

    def __init__(self, settings: FleeingSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        distances = Distances(infrared)
        self._front = distances.of(*FRONT)
        self._edges = distances.of(FRONT_LEFT_EDGE, FRONT_RIGHT_EDGE)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Name of the action."""
        want = self._settings
        left, right = self._edges(infrared_counts)
        if min(self._front(infrared_counts)) < want.front_m or min(left, right) < want.edge_m:
            return "whirl_left"
        if min(left, right) < want.wary_m:
            return "curve_left" if right <= left else "curve_right"
        return "flee"
