"""Through streets: straight on, left or right at the next junction, in the middle of the street on the way."""

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


class StreetsSettings(PolicySettings):
    """What the teacher looks for; distances from the sensor's face."""

    beside_m: Distance
    """Distance to a wall on either side in the middle of the street."""
    tolerance_m: Annotated[float, Field(gt=0, le=0.2)]
    """Dead band round the middle in which the robot drives straight on."""
    heading_weight_m: Annotated[float, Field(ge=0, le=1)]
    """Metres of error that one radian of heading error counts for."""
    front_m: Distance
    """A wall ahead nearer than this makes the robot turn on the spot."""
    edge_m: Distance
    """A corner nearer than this to a sensor that looks ahead to the side makes the robot turn away from it."""
    open_m: Distance
    """A wall farther than this leaves a side open."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """The policy."""
        return Streets(self, infrared)


class Streets:
    """Keeps to the middle between both walls, or off the one there is; curves round the corner where it is to turn."""

    def __init__(self, settings: StreetsSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        distances = Distances(infrared)
        self._front = distances.of(*FRONT)
        self._edges = distances.of(FRONT_LEFT_EDGE, FRONT_RIGHT_EDGE)
        self._left = distances.of(*LEFT_FRONT_TO_BACK)
        self._right = distances.of(*RIGHT_FRONT_TO_BACK)
        front_m, *_, back_m = distances.ahead_m(*LEFT_FRONT_TO_BACK)
        self._baseline_m = front_m - back_m

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:
        """Name of the action."""
        want = self._settings
        left_edge, right_edge = self._edges(infrared_counts)
        if min(self._front(infrared_counts)) < want.front_m:
            return "spin_right" if behaviour == "turn_right" else "spin_left"
        if min(left_edge, right_edge) < want.edge_m:
            # Curves, since spins at one corner and at the other would undo each other for ever.
            return "curve_right" if left_edge < right_edge else "curve_left"
        left, right = self._left(infrared_counts), self._right(infrared_counts)
        if behaviour == "turn_left" and min(left[:2]) > want.open_m:
            return "curve_left"
        if behaviour == "turn_right" and min(right[:2]) > want.open_m:
            return "curve_right"
        errors_m = [error for error in (self._error_m(left), self._minus(self._error_m(right))) if error is not None]
        if not errors_m:
            return "forward"
        error_m = sum(errors_m) / len(errors_m)
        side = "left" if error_m > 0 else "right"
        if abs(error_m) > 3 * want.tolerance_m:
            return f"curve_{side}"
        return f"bear_{side}" if abs(error_m) > want.tolerance_m else "forward"

    def _error_m(self, wall: tuple[float, ...]) -> float | None:
        """How much too far off the wall, or turned from it; None where there is none along the whole side."""
        if max(wall) > self._settings.open_m:
            return None
        turned_away = (wall[0] - wall[-1]) / self._baseline_m
        return min(wall) - self._settings.beside_m + self._settings.heading_weight_m * turned_away

    @staticmethod
    def _minus(error_m: float | None) -> float | None:
        return None if error_m is None else -error_m
