"""A circle, counter-clockwise, round an object that is smaller than the distance between two sensors."""

from typing import Annotated

from pydantic import Field

from behaviors.policies.distances import (
    FRONT,
    FRONT_LEFT_EDGE,
    FRONT_RIGHT_EDGE,
    LEFT_FRONT_TO_BACK,
    REAR,
    REAR_LEFT_EDGE,
    REAR_RIGHT_EDGE,
    RIGHT_FRONT_TO_BACK,
    Distances,
)
from behaviors.policies.policy import PolicySettings, ReferencePolicy
from hal.robot_settings import InfraredSettings

Distance = Annotated[float, Field(ge=0.05, le=0.6)]


class CircleSettings(PolicySettings):
    """What the teacher looks for; distances from the sensor's face."""

    wanted_m: Distance
    """Distance to the object on the left."""
    near_m: Distance
    """An obstacle ahead nearer than this makes the robot turn right on the spot, until it is on the left."""
    lost_m: Distance
    """What is farther than this is not seen."""
    inward_share: Annotated[float, Field(ge=0, le=5)]
    """Metres ahead of the robot's centre at which the object should lie, for each metre that it is too far off."""
    tolerance_m: Annotated[float, Field(gt=0, le=0.3)]
    """How far ahead of, or behind, that place it may lie."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """The policy."""
        return Circle(self, infrared)


class Circle:
    """Curve left with the object abeam; less while it lies ahead, more while it lies behind."""

    def __init__(self, settings: CircleSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        distances = Distances(infrared)
        self._left = distances.of(*LEFT_FRONT_TO_BACK)
        self._left_ahead_m = distances.ahead_m(*LEFT_FRONT_TO_BACK)
        self._front = distances.of(*FRONT)
        self._to_turn_right = distances.of(FRONT_RIGHT_EDGE, *RIGHT_FRONT_TO_BACK, REAR_RIGHT_EDGE)
        self._to_turn_left = distances.of(*REAR, REAR_LEFT_EDGE)
        self._edge = distances.of(FRONT_LEFT_EDGE)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Name of the action."""
        want = self._settings
        front = min(self._front(infrared_counts))
        left = self._left(infrared_counts)
        nearest = min(left)
        (edge,) = self._edge(infrared_counts)
        if front < want.near_m or edge < want.wanted_m / 2:
            return "spin_right"
        if nearest < want.lost_m:
            ahead_m = self._left_ahead_m[left.index(nearest)]
            error_m = ahead_m - want.inward_share * (nearest - want.wanted_m)
            if error_m > want.tolerance_m:
                return "bear_right" if error_m > 3 * want.tolerance_m else "forward"
            return "spin_left" if error_m < -3 * want.tolerance_m else "curve_left"
        if edge < want.lost_m or front < want.lost_m:
            return "forward"
        if min(self._to_turn_right(infrared_counts)) < want.lost_m:
            return "spin_right"
        if min(self._to_turn_left(infrared_counts)) < want.lost_m:
            return "spin_left"
        return "curve_left"
