"""Street driving in the middle of the street: straight on, left or right at the next junction."""

import math
from typing import Annotated, ClassVar, NamedTuple

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
from hal.numerics import cos_sin
from hal.robot_settings import InfraredSettings

Tolerance = Annotated[float, Field(gt=0, le=0.2)]

Front = tuple[float, float, float]
"""Distances in m of the sensors in front, from left to right."""
Side = tuple[float, float, float, float, float, float]
"""Distances in m of the sensors of one side from front to back, with the edges."""
Ray = tuple[float, float, float, float]
"""Sensor's place ahead and towards its side, in m, and the same of its direction, dimensionless."""
Rays = tuple[Ray, Ray, Ray, Ray, Ray, Ray]
_FIRST_BESIDE, _BEHIND_BESIDE, _SENSORS = 1, 5, 6

ACTIONS = (
    "forward",
    *("spin_left", "spin_right"),
    *("sharp_left", "sharp_right"),
    *("bear_left", "bear_right"),
)
_FORWARD, _SPIN, _SHARP, _BEAR = 0, 1, 3, 5
_LEFT, _RIGHT = 0, 1
KEEPS_MIDDLE = -1
"""Answer of `turn_at_once` for a robot that keeps to the middle of the street."""
STRAIGHT_ON = -1
"""Turn of a robot that goes straight on; else the side that it turns to, 0 for the left and 1 for the right."""


class StreetsSettings(PolicySettings):
    """Thresholds of the policy that drives along streets and turns at junctions.

    Distances are measured from the sensors' faces unless said otherwise.
    """

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


class Thresholds(NamedTuple):
    """Thresholds of `StreetsSettings` for one robot as plain numbers, which a batch compiles, too."""

    half_width_m: float
    look_m: float
    tolerance_m: float
    curve_m: float
    crossing_tolerance_m: float
    front_m: float
    open_m: float
    askew_m: float
    """0 for a robot that takes no notice."""
    straight_m: float
    """Infinite where every line is a wall."""
    half_across: float
    """Half the share of a front edge sensor's distance that lies across the robot's course."""


def wall_away_m(side: Side, rays: Rays, turn: int, want: Thresholds) -> float:
    """Return the distance in m of the wall on one side at `look_m` ahead of the robot's centre.

    The wall is the line through the points that the sensors of that side see; those at the edges count on the way
    straight on. Returns NaN for fewer than two points, and if one of them is more than `straight_m` off the line then.
    """
    straight_on = turn == STRAIGHT_ON
    begin, end = (0, _SENSORS) if straight_on else (_FIRST_BESIDE, _BEHIND_BESIDE)
    first = last = -1
    first_x = first_y = last_x = last_y = 0.0
    for i in range(begin, end):
        if side[i] < want.open_m:
            last = i
            last_x, last_y = rays[i][0] + rays[i][2] * side[i], rays[i][1] + rays[i][3] * side[i]
            if first < 0:
                first, first_x, first_y = last, last_x, last_y
    if first == last:
        return math.nan
    if straight_on:
        slope = (first_y - last_y) / (first_x - last_x)
        for i in range(first + 1, last):
            if side[i] < want.open_m:
                x_m, y_m = rays[i][0] + rays[i][2] * side[i], rays[i][1] + rays[i][3] * side[i]
                if abs(y_m - first_y - (x_m - first_x) * slope) > want.straight_m:
                    return math.nan
    return first_y + (want.look_m - first_x) * (first_y - last_y) / (first_x - last_x)


def turn_at_once(front: Front, left: Side, right: Side, turn: int, want: Thresholds) -> int:
    """Return the index in ACTIONS of the action that turns or avoids a wall; KEEPS_MIDDLE if neither is due.

    `turn`: STRAIGHT_ON, or the side of the turn.
    """
    straight_on = turn == STRAIGHT_ON
    front_m = min(front[0], front[1], front[2])
    wider = _LEFT if front[0] > front[2] else _RIGHT
    if front_m < want.front_m:
        return _SPIN + (wider if straight_on else turn)
    if straight_on:
        return _SHARP + wider if front_m < want.askew_m else KEEPS_MIDDLE
    side = left if turn == _LEFT else right
    return _SHARP + turn if side[_FIRST_BESIDE] > want.open_m else KEEPS_MIDDLE


def keep_middle(left: Side, right: Side, to_left_m: float, to_right_m: float, want: Thresholds) -> int:
    """Return the index in ACTIONS of the action that leads to the middle of the street.

    `to_left_m`, `to_right_m`: distances in m of the walls, as `wall_away_m` returns them.
    """
    sees_left, sees_right = not math.isnan(to_left_m), not math.isnan(to_right_m)
    error_m = 0.0  # offset of the middle to the left of the robot's course
    if sees_left and sees_right:
        error_m = (to_left_m - to_right_m) / 2
    elif sees_left:
        error_m = to_left_m - want.half_width_m
    elif sees_right:
        error_m = want.half_width_m - to_right_m
    elif max(left[0], right[0]) < want.open_m:  # two corners ahead, one to each side
        error_m = (left[0] - right[0]) * want.half_across
    crossing = min(left[_FIRST_BESIDE], right[_FIRST_BESIDE]) > want.open_m
    side = _LEFT if error_m > 0 else _RIGHT
    if abs(error_m) > want.curve_m and not crossing:
        return _SHARP + side
    tolerance_m = want.crossing_tolerance_m if crossing else want.tolerance_m
    return _BEAR + side if abs(error_m) > tolerance_m else _FORWARD


def turn_of(behaviour: str) -> int:
    """Return the turn of a taught behaviour for `turn_at_once` and `wall_away_m`."""
    return {"turn_left": _LEFT, "turn_right": _RIGHT}.get(behaviour, STRAIGHT_ON)


class Streets:
    """Policy that keeps to the middle between both walls or off the only one, and turns round open corners.

    On the way straight through a crossing the edge sensors' view of the corners decides. All side sensors look into
    the open there, and a robot that enters askew would run into the far corner. With `askew_m` and `straight_m` it
    takes the near corner for no wall, and curves away from the far one in time.
    """

    actions = ACTIONS

    def __init__(self, settings: StreetsSettings, infrared: InfraredSettings) -> None:
        distances = Distances(infrared)
        self._front = distances.of(*FRONT)
        self._left, self._right = distances.of(*LEFT_WITH_EDGES), distances.of(*RIGHT_WITH_EDGES)
        edge = infrared.sensors[infrared.names.index(FRONT_LEFT_EDGE)]
        given = settings.model_dump(exclude={"kind", "askew_m", "straight_m"})
        self.thresholds = Thresholds(
            **given,
            askew_m=settings.askew_m or 0.0,
            straight_m=settings.straight_m or math.inf,
            half_across=0.5 * cos_sin(math.radians(edge.heading_deg))[1],
        )
        self.left_rays = _rays(infrared, LEFT_WITH_EDGES, 1.0)
        self.right_rays = _rays(infrared, RIGHT_WITH_EDGES, -1.0)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:
        """Return the name of the action for the counts of all sensors and the selected taught behaviour."""
        want, turn = self.thresholds, turn_of(behaviour)
        front_left, ahead, front_right = self._front(infrared_counts)
        left, right = _side(self._left(infrared_counts)), _side(self._right(infrared_counts))
        action = turn_at_once((front_left, ahead, front_right), left, right, turn, want)
        if action == KEEPS_MIDDLE:
            to_left_m = wall_away_m(left, self.left_rays, turn, want)
            action = keep_middle(left, right, to_left_m, wall_away_m(right, self.right_rays, turn, want), want)
        return ACTIONS[action]


def _side(distances_m: tuple[float, ...]) -> Side:
    front_edge, front, mid_front, mid_back, back, rear_edge = distances_m
    return front_edge, front, mid_front, mid_back, back, rear_edge


def _rays(infrared: InfraredSettings, names: tuple[str, ...], outward: float) -> Rays:
    """Return the rays of one side's sensors from front to back; `outward` is 1 for the left side, -1 for the right."""
    first, second, third, fourth, fifth, sixth = (
        (sensor.x_m, outward * sensor.y_m, cos, outward * sin)
        for sensor in (infrared.sensors[infrared.names.index(name)] for name in names)
        for cos, sin in [cos_sin(math.radians(sensor.heading_deg))]
    )
    return first, second, third, fourth, fifth, sixth
