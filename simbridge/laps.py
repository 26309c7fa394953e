"""Laps along the outer wall, for judging a wall follower."""

import math

import shapely
import shapely.ops

from simbridge.geometry import Point
from simbridge.world import World
from simbridge.world_settings import WorldSettings

_ROBOT_M = 0.15
"""From the robot's centre to its side, and somewhat less: nowhere does it come nearer to a wall."""
_WALL_M = 0.35
"""From a wall follower's centre to its wall. Along this way corners are short, and places in them distinct."""
_NEAR_M = 0.3
"""Along the wall is where the robot is so near to that way; its sensors hardly see a wall from farther off."""
_REACH_M = 0.3
"""From one call to the next its place moves on by less, as long as it stays along one stretch of wall."""
_CORNER_M = 1.0
"""A jump in place that a corner or a bulge in its way explains; longer jumps cross the room."""


class Laps:
    """Progress along the outer wall: the place of the way round the room that is nearest to the robot, followed.

    Positive with the wall on the left, which is clockwise. Only ways along the wall make progress. A way through the
    middle leads to a place of the lap driven last, never ahead of the foremost place reached along the wall: whoever
    cuts across makes up no lap by it, however often.
    """

    def __init__(self, world: World) -> None:
        self.count = 0.0
        """Laps so far, with fractions."""
        self._world = world
        start = world.settings.start_poses[0]
        self.put((start.x_m, start.y_m))

    def put(self, position: Point) -> None:
        """The robot was put here: no progress."""
        self._surveyed = self._world.settings
        self._way = way_round(self._surveyed, position)
        self._length_m: float = self._way.length
        self._foremost = self.count
        self._two_rounds = shapely.LineString([*self._way.coords, *self._way.coords[1:]])
        self._along_m: float | None = None
        self._along_m = self._place(position)

    def follow(self, position: Point) -> None:
        """The robot came here on its own wheels, not more than some decimetres since the last call."""
        if self._world.settings is not self._surveyed:
            # A wall was moved, and what was measured along the old way means nothing on the new one.
            self.put(position)
            return
        along_m = self._place(position)
        if along_m is None:
            return
        if self._along_m is not None:
            self._advance(math.remainder(along_m - self._along_m, self._length_m))
        self._along_m = along_m

    def _advance(self, step_m: float) -> None:
        count = self.count + step_m / self._length_m
        if abs(step_m) <= _CORNER_M:
            self._foremost = min(max(self._foremost, count), count + 1.0)
        else:
            count = self._foremost - (self._foremost - count) % 1.0
        self.count = count

    def _place(self, position: Point) -> float | None:
        """Length of the way up to the robot's place; None away from the wall."""
        centre = shapely.Point(position)
        away_m: float = self._way.distance(centre)
        if away_m > _NEAR_M:
            return None
        along_m: float = self._way.project(centre)
        if self._along_m is None or abs(math.remainder(along_m - self._along_m, self._length_m)) <= _REACH_M:
            return along_m
        # In a narrow place another wall may be nearer for a while than the one it follows.
        begin_m = (self._along_m - _REACH_M) % self._length_m
        stretch = shapely.ops.substring(self._two_rounds, begin_m, begin_m + 2 * _REACH_M)
        return begin_m + float(stretch.project(centre)) if stretch.distance(centre) <= _NEAR_M else along_m


def way_round(world: WorldSettings, position: Point) -> shapely.LinearRing:
    """Clockwise way of a wall follower's centre round the room that a position is in.

    It leads along the outline and round all that stands against it or leaves no gap to pass. Islands are left out.
    """
    walls = shapely.union_all([shapely.Polygon(corners) for corners in world.solids])
    rooms = shapely.get_parts(shapely.Polygon(world.outline).difference(walls).buffer(-_ROBOT_M, quad_segs=2))
    centre = shapely.Point(position)
    room = min(rooms, key=lambda part: float(part.distance(centre)))
    apart = room.buffer(_ROBOT_M - _WALL_M, quad_segs=2)
    # Where it would not get through a narrow place so far from both walls, it goes as near to them as it can.
    way = (apart if isinstance(apart, shapely.Polygon) and not apart.is_empty else room).exterior
    return way.reverse() if way.is_ccw else way
