"""Fleeing with collision avoidance: turn away from whatever is near, and be off."""

from typing import Annotated

from pydantic import Field

from behaviors.policies.distances import (
    FRONT,
    FRONT_LEFT_EDGE,
    FRONT_RIGHT_EDGE,
    LEFT_FRONT_TO_BACK,
    RIGHT_FRONT_TO_BACK,
    Distances,
)
from behaviors.policies.policy import PolicySettings, ReferencePolicy
from hal.robot_settings import InfraredSettings

Distance = Annotated[float, Field(ge=0.05, le=0.6)]


class FleeingSettings(PolicySettings):
    """What the teacher looks for; distances from the sensor's face."""

    front_m: Distance
    """An obstacle ahead nearer than this makes the robot turn on the spot."""
    edge_m: Distance
    """The same for the sensors that look ahead to the sides."""
    side_m: Distance
    """An obstacle beside the robot nearer than this makes it bear away."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """The policy."""
        return Fleeing(self, infrared)


class Fleeing:
    """Always turns left at what is ahead: turning to the freer side opposes itself in a corner."""

    def __init__(self, settings: FleeingSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        distances = Distances(infrared)
        self._front = distances.of(*FRONT)
        self._edges = distances.of(FRONT_LEFT_EDGE, FRONT_RIGHT_EDGE)
        self._left = distances.of(*LEFT_FRONT_TO_BACK)
        self._right = distances.of(*RIGHT_FRONT_TO_BACK)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Name of the action."""
        want = self._settings
        if min(self._front(infrared_counts)) < want.front_m or min(self._edges(infrared_counts)) < want.edge_m:
            return "spin_left"
        left, right = min(self._left(infrared_counts)), min(self._right(infrared_counts))
        if min(left, right) < want.side_m:
            return "bear_right" if left < right else "bear_left"
        return "forward"
