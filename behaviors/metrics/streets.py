"""Streets, junctions and where they lead, as a dispatcher's map shows them; streets run along the axes."""

import math
from dataclasses import dataclass
from enum import IntEnum

from hal.simulation import Pose, WorldPlan

_ON_LINE_M = 0.01


class Side(IntEnum):
    """Sides of a junction, and ways that lead there: each a quarter turn to the left of the one before."""

    EAST = 0
    NORTH = 1
    WEST = 2
    SOUTH = 3

    def turned(self, quarters: int) -> "Side":
        """Return the side after so many quarter turns to the left; negative: to the right."""
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
    """Junction of streets."""

    x_m: float
    y_m: float
    half_width_m: float
    """Half the width of the streets that lead north and south; half its extent in x."""
    half_height_m: float
    """The same for those that lead east and west, in y."""
    arms: frozenset[Side]
    """Sides at which a street goes on."""

    def holds(self, pose: Pose, margin_m: float = 0.0) -> bool:
        """Return whether a pose lies in the junction, or at most `margin_m` outside."""
        return (
            abs(pose.x_m - self.x_m) <= self.half_width_m + margin_m
            and abs(pose.y_m - self.y_m) <= self.half_height_m + margin_m
        )

    def side_of(self, pose: Pose) -> Side:
        """Return the side of the junction that a pose in or next to it is nearest to."""
        return side_towards((pose.x_m - self.x_m) / self.half_width_m, (pose.y_m - self.y_m) / self.half_height_m)


@dataclass(frozen=True, slots=True)
class Lane:
    """The middle line of a street."""

    level: bool
    """East to west."""
    line_m: float
    """Its y when level, else its x."""
    from_m: float
    to_m: float
    """Start and end along the other axis."""
    half_width_m: float

    def deviation_m(self, pose: Pose) -> float | None:
        """Return the distance in m of a pose from the middle; None off the street."""
        along_m, across_m = (pose.x_m, pose.y_m) if self.level else (pose.y_m, pose.x_m)
        away_m = abs(across_m - self.line_m)
        return away_m if away_m <= self.half_width_m and self.from_m <= along_m <= self.to_m else None


class StreetMap:
    """All streets and junctions of a world."""

    def __init__(self, plan: WorldPlan) -> None:
        self.lanes = tuple(_lane(each.from_m, each.to_m, each.width_m) for each in plan.streets)
        self.junctions = tuple(self._junction(x_m, y_m) for x_m, y_m in plan.junctions)

    def junction_at(self, pose: Pose) -> Junction | None:
        """Return the junction that a pose lies in; None outside of all junctions."""
        return next((each for each in self.junctions if each.holds(pose)), None)

    def deviation_m(self, pose: Pose) -> float | None:
        """Return the distance in m of a pose from the middle of its street; None in junctions and off streets."""
        if self.junction_at(pose) is not None:
            return None
        deviations_m = [away_m for lane in self.lanes if (away_m := lane.deviation_m(pose)) is not None]
        return min(deviations_m, default=None)

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
        return Junction(x_m, y_m, max(widths_m, default=widest_m), max(heights_m, default=widest_m), frozenset(arms))


def _lane(from_m: tuple[float, float], to_m: tuple[float, float], width_m: float) -> Lane:
    (ax, ay), (bx, by) = from_m, to_m
    level = math.fabs(bx - ax) >= math.fabs(by - ay)
    along_m = sorted((ax, bx) if level else (ay, by))
    return Lane(level, (ay + by) / 2 if level else (ax + bx) / 2, along_m[0], along_m[1], width_m / 2)
