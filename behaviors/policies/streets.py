"""Street driving in the middle of the street: straight on, left or right at the next junction."""

import math
from collections.abc import Sequence
from typing import Annotated, ClassVar

from pydantic import Field

from behaviors.policies.distances import (
    FRONT,
    FRONT_LEFT_EDGE,
    LEFT_WITH_EDGES,
    RIGHT_WITH_EDGES,
    Distance,
    Distances,
)
from behaviors.policies.policy import PolicySettings, ReferencePolicy
from hal.robot_settings import InfraredSettings

Tolerance = Annotated[float, Field(gt=0, le=0.2)]

_BESIDE = slice(1, -1)
_FIRST_BESIDE = 1


class StreetsSettings(PolicySettings):
    """Thresholds; distances from the sensors' faces unless said otherwise."""

    behaviours: ClassVar[tuple[str, ...] | None] = ("straight_on", "turn_left", "turn_right")
    half_width_m: Annotated[float, Field(ge=0.2, le=0.8)]
    """Distance from the middle of the street to a wall, used if only one wall is seen."""
    look_m: Annotated[float, Field(ge=0, le=1)]
    """Look-ahead from the robot's centre; it corrects the heading as well."""
    tolerance_m: Tolerance
    """Dead band round the middle of the street."""
    curve_m: Tolerance
    """Distance from the middle above which the robot takes a sharp curve."""
    crossing_tolerance_m: Tolerance
    """Dead band in a crossing, where only corners are seen."""
    front_m: Distance
    """Distance ahead below which the robot turns on the spot."""
    open_m: Distance
    """Distance above which a side is open."""
    askew_m: Distance | None = None
    """Distance ahead below which a robot that goes straight on is askew and curves away; None: it takes no notice."""
    straight_m: Tolerance | None = None
    """Largest distance of a point from a wall's line; beyond it a robot that goes straight on sees a corner, no wall.
    None: every line is a wall."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """Return a policy with these thresholds. Raises KeyError if the robot lacks one of its sensors."""
        return Streets(self, infrared)


class Streets:
    """Keep to the middle between both walls or off the only one; turn round the corner of an open side.

    On the way straight through a crossing the edge sensors' view of the corners decides. All side sensors look into
    the open there, and a robot that enters askew would run into the far corner. With `askew_m` and `straight_m` it
    takes the near corner for no wall, and curves away from the far one in time.
    """

    def __init__(self, settings: StreetsSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        distances = Distances(infrared)
        self._front = distances.of(*FRONT)
        self._left, self._right = distances.of(*LEFT_WITH_EDGES), distances.of(*RIGHT_WITH_EDGES)
        self._left_wall = _Wall(infrared, LEFT_WITH_EDGES, 1.0)
        self._right_wall = _Wall(infrared, RIGHT_WITH_EDGES, -1.0)
        edge = infrared.sensors[infrared.names.index(FRONT_LEFT_EDGE)]
        self._half_across = 0.5 * math.sin(math.radians(edge.heading_deg))

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:
        """Return the name of the action for the counts of all sensors and the selected taught behaviour."""
        want = self._settings
        front = self._front(infrared_counts)
        left, right = self._left(infrared_counts), self._right(infrared_counts)
        turn = _turn_of(behaviour)
        if min(front) < want.front_m:
            return f"spin_{turn or ('left' if front[0] > front[-1] else 'right')}"
        if turn and (left if turn == "left" else right)[_FIRST_BESIDE] > want.open_m:
            return f"sharp_{turn}"
        if not turn and want.askew_m is not None and min(front) < want.askew_m:
            return f"sharp_{'left' if front[0] > front[-1] else 'right'}"
        crossing = min(left[_FIRST_BESIDE], right[_FIRST_BESIDE]) > want.open_m
        error_m = self._error_m(left, right, straight_on=not turn)
        side = "left" if error_m > 0 else "right"
        if abs(error_m) > want.curve_m and not crossing:
            return f"sharp_{side}"
        tolerance_m = want.crossing_tolerance_m if crossing else want.tolerance_m
        return f"bear_{side}" if abs(error_m) > tolerance_m else "forward"

    def _error_m(self, left: Sequence[float], right: Sequence[float], *, straight_on: bool) -> float:
        """Return the offset in m of the street's middle to the left of the robot's course."""
        want = self._settings
        sensors = slice(None) if straight_on else _BESIDE
        straight_m = math.inf if want.straight_m is None or not straight_on else want.straight_m
        to_left_m, to_right_m = (
            wall.away_m(distances[sensors], sensors, want, straight_m)
            for wall, distances in ((self._left_wall, left), (self._right_wall, right))
        )
        if to_left_m is not None and to_right_m is not None:
            return (to_left_m - to_right_m) / 2
        if to_left_m is not None:
            return to_left_m - want.half_width_m
        if to_right_m is not None:
            return want.half_width_m - to_right_m
        if max(left[0], right[0]) < want.open_m:  # two corners ahead, one to each side
            return (left[0] - right[0]) * self._half_across
        return 0.0


class _Wall:
    """Line of the wall on one side, fitted through the points that the sensors of that side see."""

    def __init__(self, infrared: InfraredSettings, names: Sequence[str], outward: float) -> None:
        """Args: sensor `names` from front to back; `outward` is 1 for the left side, -1 for the right."""
        sensors = [infrared.sensors[infrared.names.index(name)] for name in names]
        self._rays = [
            (
                sensor.x_m,
                outward * sensor.y_m,
                math.cos(math.radians(sensor.heading_deg)),
                outward * math.sin(math.radians(sensor.heading_deg)),
            )
            for sensor in sensors
        ]

    def away_m(
        self, distances: Sequence[float], sensors: slice, want: StreetsSettings, straight_m: float
    ) -> float | None:
        """Return the wall's distance in m at `look_m` ahead of the robot's centre.

        Returns None for fewer than two points, and if one of them is more than `straight_m` off the line.
        """
        points = [
            (x_m + along * distance_m, y_m + across * distance_m)
            for (x_m, y_m, along, across), distance_m in zip(self._rays[sensors], distances, strict=True)
            if distance_m < want.open_m
        ]
        if len(points) < 2:
            return None
        (first_x, first_y), (last_x, last_y) = points[0], points[-1]
        slope = (first_y - last_y) / (first_x - last_x)
        if any(abs(y_m - first_y - (x_m - first_x) * slope) > straight_m for x_m, y_m in points[1:-1]):
            return None
        return first_y + (want.look_m - first_x) * (first_y - last_y) / (first_x - last_x)


def _turn_of(behaviour: str) -> str:
    return behaviour.removeprefix("turn_") if behaviour.startswith("turn_") else ""
