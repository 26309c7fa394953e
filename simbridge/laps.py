"""Laps along the outer wall, for judging a wall follower."""

import math

from simbridge.geometry import Edge, Point, edges_of, point_distance_m, signed_area_m2
from simbridge.world import World
from simbridge.world_settings import WorldSettings


class Laps:
    """Progress along the contour of the room: its point nearest to the robot, followed as it wanders round.

    Positive with the wall on the left, which is clockwise. The contour is the outline with a detour round each wall
    that stands against it, since that is the way a wall follower takes. Progress is meant for a robot near the wall:
    in the middle of a room the nearest point changes sides.
    """

    def __init__(self, world: World) -> None:
        self.count = 0.0
        """Laps so far, with fractions."""
        self._world = world
        self._along_m = 0.0
        self._survey(world.settings)

    def put(self, position: Point) -> None:
        """The robot was put here: no progress."""
        self._along_m = self._project(position)

    def follow(self, position: Point) -> None:
        """The robot came here on its own wheels, less than half a lap since the last call."""
        if self._world.settings is not self._surveyed:
            # A wall was moved, and what was measured along the old contour means nothing on the new one.
            self._survey(self._world.settings)
            self.put(position)
        along_m = self._project(position)
        self.count += math.remainder(along_m - self._along_m, self._perimeter_m) / self._perimeter_m
        self._along_m = along_m

    def _survey(self, world: WorldSettings) -> None:
        """Measure the contour: of each edge its start, direction, length, and place along the whole."""
        self._surveyed = world
        self._edges: list[tuple[float, float, float, float, float, float]] = []
        along_m = 0.0
        for (ax, ay), (bx, by) in edges_of(contour(world)):
            length_m = math.hypot(bx - ax, by - ay)
            if length_m > 0.0:
                self._edges.append((ax, ay, (bx - ax) / length_m, (by - ay) / length_m, length_m, along_m))
                along_m += length_m
        self._perimeter_m = along_m

    def _project(self, position: Point) -> float:
        x, y = position
        nearest2, found_m = math.inf, 0.0
        for ax, ay, ux, uy, length_m, start_m in self._edges:
            dx, dy = x - ax, y - ay
            along_m = min(length_m, max(0.0, dx * ux + dy * uy))
            away2 = (dx - along_m * ux) ** 2 + (dy - along_m * uy) ** 2
            if away2 < nearest2:
                nearest2, found_m = away2, start_m + along_m
        return found_m


def contour(world: WorldSettings) -> list[Point]:
    """Corners of the outline, clockwise, with a detour round each wall that has one end at it."""
    corners = list(world.outline[:-1])
    if signed_area_m2(corners) > 0:
        corners.reverse()
    found: list[Point] = []
    for edge in edges_of(corners):
        found.append(edge[0])
        detours = []
        for wall in world.walls:
            # Corners run along one side of the wall and back along the other; 0 and 3 are those at its end `to_m`.
            to_left, from_left, from_right, to_right = wall.corners
            if point_distance_m(wall.from_m, edge) <= wall.thickness_m:
                detours.append((from_left, to_left, to_right, from_right))
            elif point_distance_m(wall.to_m, edge) <= wall.thickness_m:
                detours.append((to_right, from_right, from_left, to_left))
        for detour in sorted(detours, key=lambda way: _share_along(edge, way[0])):
            forward = _share_along(edge, detour[0]) < _share_along(edge, detour[3])
            found += detour if forward else detour[::-1]
    return found


def _share_along(edge: Edge, point: Point) -> float:
    (ax, ay), (bx, by) = edge
    return (point[0] - ax) * (bx - ax) + (point[1] - ay) * (by - ay)
