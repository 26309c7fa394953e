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

_UNSEEN = len(LEFT_FRONT_TO_BACK)
"""Place of a column, from front to back, that none of a side's sensors sees: behind all others."""


class EightSettings(PolicySettings):
    """What the teacher looks for; distances from the sensor's face."""

    near_m: Distance
    """A column nearer than this makes the robot drive straight on."""
    far_m: Distance
    """Farther than this the column may only be ahead of abeam a little: the robot curves in sooner."""
    front_m: Distance
    """An obstacle ahead nearer than this makes the robot turn on the spot, away from the column beside it."""
    lost_m: Distance
    """What is farther than this is not seen."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """The policy."""
        return Eight(self, infrared)


class Eight:
    """Goes round the column that lies farther ahead; straight on from one to the other.

    So it needs no memory: it leaves a column as soon as the other one comes into view, and then it has its back to it.
    """

    def __init__(self, settings: EightSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        distances = Distances(infrared)
        self._front = distances.of(*FRONT)
        self._edges = distances.of(FRONT_LEFT_EDGE, FRONT_RIGHT_EDGE)
        self._left = distances.of(*LEFT_FRONT_TO_BACK)
        self._right = distances.of(*RIGHT_FRONT_TO_BACK)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Name of the action."""
        want = self._settings
        left, right = self._left(infrared_counts), self._right(infrared_counts)
        left_edge, right_edge = self._edges(infrared_counts)
        if min(self._front(infrared_counts)) < want.front_m:
            return "spin_right" if min(left) <= min(right) else "spin_left"
        at_left, at_right = self._place(left), self._place(right)
        if at_left == at_right == _UNSEEN and min(left_edge, right_edge) >= want.lost_m:
            return "curve_left"
        # Across: the other column is ahead to the side where nothing is abeam yet.
        if (at_left == _UNSEEN and left_edge < want.lost_m) or (at_right == _UNSEEN and right_edge < want.lost_m):
            return "forward"
        if at_left <= at_right:
            return self._round(left, at_left, at_right, "left")
        return self._round(right, at_right, at_left, "right")

    def _place(self, side: tuple[float, ...]) -> int:
        """Which sensor of a side, from front to back, is nearest to the column."""
        nearest = min(side)
        return side.index(nearest) if nearest < self._settings.lost_m else _UNSEEN

    def _round(self, side: tuple[float, ...], at: int, other_at: int, name: str) -> str:
        want = self._settings
        if other_at < _UNSEEN and at <= 1:  # across, too: the other one is behind
            return "forward"
        nearest = min(side)
        if nearest < want.near_m:
            return "forward" if at < len(side) - 1 else f"bear_{name}"
        ahead = at == 0 if nearest > want.far_m else at <= 1
        return f"bear_{name}" if ahead else f"curve_{name}"
