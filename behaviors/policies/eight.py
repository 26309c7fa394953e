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
    """Thresholds; distances from the sensors' faces."""

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


class _Column(NamedTuple):
    """View of a column by the sensors of one side."""

    place: int
    beside_m: float
    edge_m: float


class Eight:
    """Curve round the column that lies farther ahead, straight on from one column to the other.

    No memory is needed: the robot leaves a column once the other one comes into view, and then has its back to it.
    """

    def __init__(self, settings: EightSettings, infrared: InfraredSettings) -> None:
        self._settings = settings
        distances = Distances(infrared)
        self._front = distances.of(*FRONT)
        self._left = distances.of(*LEFT_WITH_EDGES)
        self._right = distances.of(*RIGHT_WITH_EDGES)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Return the name of the action for the counts of all sensors; `behaviour` is not used."""
        left, right = self._column(self._left(infrared_counts)), self._column(self._right(infrared_counts))
        if min(self._front(infrared_counts)) < self._settings.front_m:
            to_left_m, to_right_m = min(left.beside_m, left.edge_m), min(right.beside_m, right.edge_m)
            return "spin_right" if to_left_m <= to_right_m else "spin_left"
        if left.place <= right.place:
            return self._round(left, right, "left", "right")
        return self._round(right, left, "right", "left")

    def _column(self, side: tuple[float, ...]) -> _Column:
        want = self._settings
        edge_m, *at_side, rear_m = side
        beside_m = min(at_side)
        if beside_m < want.lost_m:
            place = at_side.index(beside_m)
        elif edge_m < want.edge_m:
            place = _AHEAD
        else:
            place = _BEHIND if rear_m < want.rear_m else _NOWHERE
        return _Column(place, beside_m, edge_m)

    def _round(self, column: _Column, other: _Column, here: str, away: str) -> str:
        """Return the action round the column that lies farther ahead, on the side `here`."""
        want = self._settings
        if column.place == _NOWHERE:
            return "curve_left"
        if column.place == _AHEAD:  # across to it
            return f"curve_{away}" if column.edge_m < want.close_m else "forward"
        if column.place == _BEHIND:
            return f"sharp_{here}"
        if column.place == _FOREMOST and other.place < _NOWHERE:  # still on the way across
            return "forward"
        tighter = (
            (column.place == _HINDMOST)
            - (column.place == _FOREMOST)
            + (column.beside_m > want.far_m)
            - (column.beside_m < want.near_m)
        )
        if tighter > 0:
            return f"sharp_{here}"
        return f"bear_{here}" if tighter < 0 else f"curve_{here}"
