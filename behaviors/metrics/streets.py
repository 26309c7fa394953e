"""Streets, junctions and where they lead, as a dispatcher's map shows them; streets run along the axes."""

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simbridge.contracts.areas import Area, holds
from simbridge.contracts.simulation import Pose, WorldPlan

_ON_LINE_M = 0.01


class Side(IntEnum):
    """Sides of a junction, and ways that lead there: each a quarter turn to the left of the one before."""

    EAST = 0
    NORTH = 1
    WEST = 2
    SOUTH = 3

    def turned(self, quarters: int) -> "Side":
        """Return the side after a number of quarter turns to the left; negative: to the right."""
        return Side((self + quarters) % 4)

    @property
    def heading_rad(self) -> float:
        """Heading of a robot in this direction in rad, counter-clockwise from the x axis."""
        return self * math.pi / 2


ALONG = {Side.EAST: (1, 0), Side.NORTH: (0, 1), Side.WEST: (-1, 0), Side.SOUTH: (0, -1)}
"""Unit vector of each direction, in x and y."""


def side_towards(dx: float, dy: float) -> Side:
    """Return the side nearest to the direction (dx, dy), in m or as a unit vector; x east, y north."""
    if abs(dx) >= abs(dy):
        return Side.EAST if dx > 0 else Side.WEST
    return Side.NORTH if dy > 0 else Side.SOUTH


@dataclass(frozen=True, slots=True)
class Junction:
    """Place where streets meet, and the sides at which they go on."""

    area: Area
    """Its extent is the width of the streets that lead there."""
    arms: frozenset[Side]
    """Sides at which a street goes on."""

    @property
    def x_m(self) -> float:
        """Centre of the junction in x, in m."""
        return self.area.x_m

    @property
    def y_m(self) -> float:
        """Centre of the junction in y, in m."""
        return self.area.y_m

    @property
    def half_width_m(self) -> float:
        """Half the width of the streets that lead north and south."""
        return self.area.half_width_m

    @property
    def half_height_m(self) -> float:
        """Half the width of the streets that lead east and west."""
        return self.area.half_height_m

    def holds(self, pose: Pose, margin_m: float = 0.0) -> bool:
        """Return whether a pose lies in the junction, or at most `margin_m` outside."""
        return holds(pose.x_m, pose.y_m, self.area, margin_m)

    def side_of(self, pose: Pose) -> Side:
        """Return the side of the junction that a pose in or next to it is nearest to."""
        return side_towards((pose.x_m - self.x_m) / self.half_width_m, (pose.y_m - self.y_m) / self.half_height_m)


@dataclass(frozen=True, slots=True)
class Lane:
    """Middle line of a straight street across all its junctions; a robot's deviation is measured from it."""

    level: bool
    """True if the street runs from east to west, False from north to south."""
    line_m: float
    """Its y when level, else its x."""
    from_m: float
    to_m: float
    """Start and end along the other axis."""
    half_width_m: float


class StreetMap:
    """Streets and junctions of a world; it finds those at a pose, for the metrics of junctions and routes."""

    def __init__(self, plan: WorldPlan) -> None:
        self.lanes = tuple(_lane(each.from_m, each.to_m, each.width_m) for each in plan.streets)
        self.junctions = tuple(self._junction(x_m, y_m) for x_m, y_m in plan.junctions)
        self._areas: Any = Area(*np.array([each.area for each in self.junctions]).reshape(-1, 4).T)
        """Each field of all areas, (junctions,)."""
        level, *numbers = np.array([astuple(lane) for lane in self.lanes]).reshape(-1, 5).T
        self._level, self._lane_numbers = level != 0.0, numbers

    def junction_at(self, pose: Pose) -> Junction | None:
        """Return the junction that a pose lies in; None outside of all junctions."""
        return self.junctions_at([pose])[0]

    def junctions_at(self, poses: Sequence[Pose]) -> list[Junction | None]:
        """Return the junction that each pose lies in; None outside of all junctions."""
        inside = self._inside(np.array(poses))
        places = np.where(inside.any(axis=1), inside.argmax(axis=1), -1)
        return [None if place < 0 else self.junctions[place] for place in places.tolist()]

    def deviation_m(self, pose: Pose) -> float | None:
        """Return the distance in m of a pose from the middle of its street; None in junctions and off streets."""
        return next(iter(self.deviations_m([pose])), None)

    def deviations_m(self, poses: Sequence[Pose]) -> list[float]:
        """Return the distance in m from the middle of its street, of each pose in a street and no junction."""
        if not poses:
            return []
        at = np.array(poses)
        line_m, from_m, to_m, half_width_m = self._lane_numbers
        x_m, y_m = at[:, :1], at[:, 1:2]
        along_m, across_m = np.where(self._level, x_m, y_m), np.where(self._level, y_m, x_m)
        away_m = abs(across_m - line_m)
        in_lane = (away_m <= half_width_m) & (from_m <= along_m) & (along_m <= to_m)
        least_m = np.where(in_lane, away_m, np.inf).min(axis=1, initial=np.inf)
        counts = np.isfinite(least_m) & ~self._inside(at).any(axis=1)
        nearest_m: list[float] = least_m[counts].tolist()
        return nearest_m

    def _inside(self, at: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return whether each pose (n, 3) in m and rad lies in each junction, (n, junctions)."""
        x_m: Any = at[:, :1]
        y_m: Any = at[:, 1:2]
        inside: Any = holds(x_m, y_m, self._areas, 0.0)
        table: NDArray[np.bool_] = inside
        return table

    def next_junction(self, pose: Pose, way: Side) -> Junction | None:
        """Return the next junction in the direction `way` along the street of a pose; None without one."""
        along_x, along_y = ALONG[way]
        ahead = [
            (along_m, each)
            for each in self.junctions
            if (along_m := (each.x_m - pose.x_m) * along_x + (each.y_m - pose.y_m) * along_y) > 0.0
            and abs((each.x_m - pose.x_m) * along_y) <= each.half_width_m
            and abs((each.y_m - pose.y_m) * along_x) <= each.half_height_m
        ]
        return min(ahead, key=lambda pair: pair[0])[1] if ahead else None

    def neighbour(self, junction: Junction, way: Side) -> Junction | None:
        """Return the next junction in the direction `way` along the street that leaves a junction; None without one."""
        along_x, along_y = ALONG[way]
        x_m, y_m = junction.x_m + along_x * junction.half_width_m, junction.y_m + along_y * junction.half_height_m
        return self.next_junction(Pose(x_m, y_m, way.heading_rad), way)  # from its edge, to miss its own middle

    def _junction(self, x_m: float, y_m: float) -> Junction:
        arms: set[Side] = set()
        widths_m: list[float] = []
        heights_m: list[float] = []
        for lane in self.lanes:
            along_m, across_m = (x_m, y_m) if lane.level else (y_m, x_m)
            begins, ends = lane.from_m + _ON_LINE_M < along_m, along_m < lane.to_m - _ON_LINE_M
            on_it = lane.from_m - _ON_LINE_M <= along_m <= lane.to_m + _ON_LINE_M
            if not on_it or abs(across_m - lane.line_m) > _ON_LINE_M:
                continue
            (heights_m if lane.level else widths_m).append(lane.half_width_m)
            if begins:
                arms.add(Side.WEST if lane.level else Side.SOUTH)
            if ends:
                arms.add(Side.EAST if lane.level else Side.NORTH)
        widest_m = max([*widths_m, *heights_m])
        area = Area(x_m, y_m, max(widths_m, default=widest_m), max(heights_m, default=widest_m))
        return Junction(area, frozenset(arms))


def _lane(from_m: tuple[float, float], to_m: tuple[float, float], width_m: float) -> Lane:
    (ax, ay), (bx, by) = from_m, to_m
    level = math.fabs(bx - ax) >= math.fabs(by - ay)
    along_m = sorted((ax, bx) if level else (ay, by))
    return Lane(level, (ay + by) / 2 if level else (ax + bx) / 2, along_m[0], along_m[1], width_m / 2)
