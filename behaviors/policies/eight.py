"""An eight round two columns: the one on the left counter-clockwise, the one on the right clockwise."""

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


class EightSettings(PolicySettings):
    """What the teacher looks for; distances from the sensor's face."""

    wanted_m: Distance
    """Distance to the column beside the robot."""
    tolerance_m: Annotated[float, Field(gt=0, le=0.2)]
    """Dead band round it in which the robot keeps its curve."""
    front_m: Distance
    """An obstacle ahead nearer than this makes the robot turn right on the spot."""
    lost_m: Distance
    """What is farther than this is not seen."""
    heading_weight: Annotated[float, Field(ge=0, le=2)]
    """Metres of error for each metre by which the column is farther from the front sensor than from the back one."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """The policy."""
        return Eight(self, infrared)


class Eight:
    """Goes round the column that lies more ahead; straight on from one to the other when both do.

    So it needs no memory: it leaves a column as soon as the other one comes into view, and then it has its back to it.
    """

    def __init__(self, settings: EightSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        distances = Distances(infrared)
        self._front = distances.of(*FRONT)
        self._left = distances.of(FRONT_LEFT_EDGE, *LEFT_FRONT_TO_BACK)
        self._right = distances.of(FRONT_RIGHT_EDGE, *RIGHT_FRONT_TO_BACK)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Name of the action."""
        want = self._settings
        if min(self._front(infrared_counts)) < want.front_m:
            return "spin_right"
        left, right = self._left(infrared_counts), self._right(infrared_counts)
        left_ahead, right_ahead = min(left[:2]) < want.lost_m, min(right[:2]) < want.lost_m
        left_seen, right_seen = min(left) < want.lost_m, min(right) < want.lost_m
        if left_ahead and right_ahead:
            return "forward"
        if right_ahead or (right_seen and not left_seen):
            return self._round(right[1:], "right", "left")
        if left_seen and (left_ahead or not right_seen):
            return self._round(left[1:], "left", "right")
        return "forward" if left_seen else "curve_left"

    def _round(self, beside: tuple[float, ...], here: str, away: str) -> str:
        want = self._settings
        if min(beside) > want.lost_m:  # only the edge sees it yet
            return "forward"
        turned_away_m = min(beside[0], want.lost_m) - min(beside[3], want.lost_m)
        error_m = min(beside) - want.wanted_m + want.heading_weight * turned_away_m
        if error_m > want.tolerance_m:
            return f"curve_{here}"
        if error_m < -3 * want.tolerance_m:
            return f"bear_{away}"
        return "forward" if error_m < -want.tolerance_m else f"bear_{here}"
