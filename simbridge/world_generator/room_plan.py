"""A room under construction: what is put in stays only if the robot still gets everywhere."""

import math
from itertools import combinations, pairwise

import shapely

from simbridge.geometry import Point, edges_of, polygons_of
from simbridge.obstacle_settings import PolygonObstacleSettings, WallSettings
from simbridge.world_generator.drivable import FOLLOWING_M, is_drivable

_SHORTEST_WALL_M = 0.3
"""Shorter ones fall between two sensors."""
_ISLAND_M = 1.2
"""From an island to all else: a robot 0.2 m from its wall, 0.33 m wide, sees 0.6 m far, and nearer ones lure it off."""
_LEAST_SEEN = 0.75
"""Share of a wall or table that must stand free; the rest may be in the wall that it leans against."""


class RoomPlan:
    """Outline, walls and tables so far."""

    def __init__(self, width_m: float, height_m: float) -> None:
        self.width_m, self.height_m = width_m, height_m
        self.corners: tuple[Point, ...] = ((0.0, 0.0), (width_m, 0.0), (width_m, height_m), (0.0, height_m), (0.0, 0.0))
        """Of the outline, counter-clockwise, the first repeated."""
        self.walls: list[WallSettings] = []
        self.tables: list[PolygonObstacleSettings] = []

    @property
    def floor(self) -> shapely.Polygon:
        """Where nothing stands; islands are holes. Chinks behind what leans against a wall are left out."""
        corners = [*(wall.corners for wall in self.walls), *(table.corners for table in self.tables)]
        shapes = [shapely.Polygon(each) for each in corners]
        pieces = polygons_of(shapely.Polygon(self.corners).difference(shapely.union_all(shapes)))
        return max(pieces, key=lambda piece: float(piece.area))

    def cut(self, corners: tuple[Point, ...]) -> bool:
        """Take a part away from the outline; False when that cannot be."""
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
        self.corners = rounded
        return True

    def stand(self, wall: WallSettings) -> bool:
        """Put a wall in; False when it would stand in the way, or mostly in another."""
        if not self._is_free(wall.corners):
            return False
        self.walls.append(wall)
        return True

    def lay(self, table: PolygonObstacleSettings) -> bool:
        """Put a table in; False when it would stand in the way, or mostly in a wall."""
        if not self._is_free(table.corners):
            return False
        self.tables.append(table)
        return True

    def edges(self, least_m: float) -> list[tuple[Point, Point]]:
        """Faces of the outline that are so long or longer."""
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
