"""Room under construction; an addition stays only if the robot can still drive everywhere."""

import math
from itertools import combinations, pairwise

import shapely

from simbridge.worlds.generator.drivable import FOLLOWING_M, is_drivable
from simbridge.worlds.geometry import Point, edges_of, polygons_of
from simbridge.worlds.obstacle_settings import PolygonObstacleSettings, WallSettings

_SHORTEST_WALL_M = 0.3
"""Least wall length; shorter ones fall between two sensors."""
_ISLAND_M = 1.2
"""Least distance from an island to other walls; a follower 0.2 m from its wall sees 0.6 m far and would switch over."""
_LEAST_SEEN = 0.75
"""Least free fraction of a wall or table; the rest may be inside the wall that it leans on."""


class RoomPlan:
    """Outline, walls and tables of a room."""

    def __init__(self, width_m: float, height_m: float) -> None:
        self.width_m, self.height_m = width_m, height_m
        self.corners: tuple[Point, ...] = ((0.0, 0.0), (width_m, 0.0), (width_m, height_m), (0.0, height_m), (0.0, 0.0))
        """Corners of the outline, counter-clockwise, the first repeated."""
        self.walls: list[WallSettings] = []
        self.tables: list[PolygonObstacleSettings] = []
        self._floor: shapely.Polygon | None = None

    @property
    def floor(self) -> shapely.Polygon:
        """Free area with islands as holes, without chinks behind leaning walls."""
        if self._floor is None:  # most additions are refused, and each of them looks at it
            self._floor = self._compute_floor()
        return self._floor

    def _compute_floor(self) -> shapely.Polygon:
        corners = [*(wall.corners for wall in self.walls), *(table.corners for table in self.tables)]
        shapes = [shapely.Polygon(each) for each in corners]
        pieces = polygons_of(shapely.Polygon(self.corners).difference(shapely.union_all(shapes)))
        return max(pieces, key=lambda piece: float(piece.area))

    def cut(self, corners: tuple[Point, ...]) -> bool:
        """Cut a polygon off the outline if possible; return whether it was."""
        left = shapely.Polygon(self.corners).difference(shapely.Polygon(corners))
        if not isinstance(left, shapely.Polygon) or left.interiors:
            return False
        coords = shapely.get_coordinates(shapely.normalize(left.simplify(0.001)))[::-1]  # normal is clockwise
        rounded = tuple((round(float(x), 2), round(float(y), 2)) for x, y in coords)
        outline = shapely.Polygon(rounded)
        if (
            any(math.dist(a, b) < _SHORTEST_WALL_M for a, b in pairwise(rounded))
            or not outline.is_valid
            or outline.bounds != (0.0, 0.0, self.width_m, self.height_m)
            or not is_drivable(outline, FOLLOWING_M)
        ):
            return False
        self.corners, self._floor = rounded, None
        return True

    def stand(self, wall: WallSettings) -> bool:
        """Add a wall unless it blocks the way or lies mostly inside another; return whether it was added."""
        if not self._is_free(wall.corners):
            return False
        self.walls.append(wall)
        self._floor = None
        return True

    def lay(self, table: PolygonObstacleSettings) -> bool:
        """Add a table unless it blocks the way or lies mostly inside a wall; return whether it was added."""
        if not self._is_free(table.corners):
            return False
        self.tables.append(table)
        self._floor = None
        return True

    def edges(self, least_m: float) -> list[tuple[Point, Point]]:
        """Return the outline's faces of at least this length."""
        return [(a, b) for a, b in edges_of(self.corners[:-1]) if math.dist(a, b) >= least_m]

    def _is_free(self, corners: tuple[Point, ...]) -> bool:
        shape, floor = shapely.Polygon(corners), self.floor
        seen_m2: float = floor.intersection(shape).area
        left = floor.difference(shape)
        if seen_m2 < _LEAST_SEEN * shape.area:
            return False
        return is_drivable(left, FOLLOWING_M) and _has_islands_out_of_sight(left)


def _has_islands_out_of_sight(floor: shapely.Geometry) -> bool:
    rings = [ring for part in polygons_of(floor) for ring in (part.exterior, *part.interiors)]
    return all(one.distance(other) >= _ISLAND_M or one.distance(other) == 0 for one, other in combinations(rings, 2))
