"""Figure of eight round two columns: counter-clockwise round the left one, clockwise round the right one."""

from typing import NamedTuple

from behaviors.policies.distances import FRONT, LEFT_WITH_EDGES, RIGHT_WITH_EDGES, Distance, Distances
from behaviors.policies.policy import PolicySettings, ReferencePolicy
from hal.robot_settings import InfraredSettings

# Place of a column from front to back; 0 to 3: index of the nearest side sensor.
_AHEAD = -1
_FOREMOST, _HINDMOST = 0, 3
_BEHIND = 4
_NOWHERE = 5


class EightSettings(PolicySettings):
    """Thresholds of the policy that drives an eight; distances in m from the sensors' faces."""

    near_m: Distance
    """Distance to a column at the side below which the robot widens the curve."""
    far_m: Distance
    """Distance above which the robot narrows the curve."""
    front_m: Distance
    """Distance ahead below which the robot spins away from the nearer column."""
    lost_m: Distance
    """Distance at the side above which a column counts as not seen."""
    edge_m: Distance
    """Threshold like `lost_m` for the front edge sensors."""
    rear_m: Distance
    """Threshold like `lost_m` for the rear edge sensors."""
    close_m: Distance
    """Distance at a front edge below which the robot curves away from the column."""

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """Return a policy with these thresholds. Raises KeyError if the robot lacks one of its sensors."""
        return Eight(self, infrared)


class Thresholds(NamedTuple):
    """Thresholds of `EightSettings` in m as plain numbers, for `choose_action`; a batch compiles both."""

    near_m: float
    far_m: float
    front_m: float
    lost_m: float
    edge_m: float
    rear_m: float
    close_m: float


Side = tuple[float, float, float, float, float, float]
"""Distances in m of the sensors of one side from front to back, with the edges."""

ACTIONS = (
    "forward",
    *("spin_left", "spin_right"),
    *("curve_left", "curve_right"),
    *("sharp_left", "sharp_right"),
    *("bear_left", "bear_right"),
)
_FORWARD, _SPIN, _CURVE, _SHARP, _BEAR = 0, 1, 3, 5, 7
_LEFT, _RIGHT = 0, 1


class Column(NamedTuple):
    """Column as the sensors of one side see it: its place along the robot, and distances in m."""

    place: int
    beside_m: float
    edge_m: float


def view_column(side: Side, want: Thresholds) -> Column:
    """Return how the sensors of one side see a column: ahead, next to one of them, at the rear, or nowhere.

    `side`: distances in m of the front edge sensor, the four at the side and the rear edge sensor.
    """
    beside_m = min(side[1], side[2], side[3], side[4])
    if beside_m < want.lost_m:
        place = _FOREMOST
        while side[1 + place] != beside_m:
            place += 1
    elif side[0] < want.edge_m:
        place = _AHEAD
    else:
        place = _BEHIND if side[5] < want.rear_m else _NOWHERE
    return Column(place, beside_m, side[0])


def choose_action(front_m: float, left: Column, right: Column, want: Thresholds) -> int:
    """Return the index in ACTIONS of the action that drives an eight; `front_m`: least distance in front.

    A batch compiles this function, too. `left`, `right`: views of the column on each side.
    """
    if front_m < want.front_m:
        to_left_m, to_right_m = min(left.beside_m, left.edge_m), min(right.beside_m, right.edge_m)
        return _SPIN + (_RIGHT if to_left_m <= to_right_m else _LEFT)
    # Round the column that lies farther ahead, on the side `here`.
    here, column, other = (_LEFT, left, right) if left.place <= right.place else (_RIGHT, right, left)
    if column.place == _NOWHERE:
        return _CURVE + _LEFT
    if column.place == _AHEAD:  # across to it
        return _CURVE + (1 - here) if column.edge_m < want.close_m else _FORWARD
    if column.place == _BEHIND:
        return _SHARP + here
    if column.place == _FOREMOST and other.place < _NOWHERE:  # still on the way across
        return _FORWARD
    tighter = (
        (column.place == _HINDMOST)
        - (column.place == _FOREMOST)
        + (column.beside_m > want.far_m)
        - (column.beside_m < want.near_m)
    )
    if tighter > 0:
        return _SHARP + here
    return (_BEAR if tighter < 0 else _CURVE) + here


class Eight:
    """Policy that drives an eight: round the column that lies farther ahead, and straight on to the other.

    No memory is needed: the robot leaves a column once the other one comes into view, and then has its back to it.
    """

    actions = ACTIONS

    def __init__(self, settings: EightSettings, infrared: InfraredSettings) -> None:
        self.thresholds = Thresholds(**settings.model_dump(exclude={"kind"}))
        distances = Distances(infrared)
        self._front = distances.of(*FRONT)
        self._left = distances.of(*LEFT_WITH_EDGES)
        self._right = distances.of(*RIGHT_WITH_EDGES)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Return the name of the action for the counts of all sensors; `behaviour` is not used."""
        want = self.thresholds
        left = view_column(_side(self._left(infrared_counts)), want)
        right = view_column(_side(self._right(infrared_counts)), want)
        return ACTIONS[choose_action(min(self._front(infrared_counts)), left, right, want)]


def _side(distances_m: tuple[float, ...]) -> Side:
    front_edge, front, mid_front, mid_back, back, rear_edge = distances_m
    return front_edge, front, mid_front, mid_back, back, rear_edge
