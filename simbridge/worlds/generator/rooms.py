"""Random rooms: convex and concave corners, slanted walls, a spur wall, tables, a displaced wall."""

import math
from itertools import combinations, pairwise

import shapely

from simbridge.worlds.generator.seeded_random import SeededRandom
from simbridge.worlds.generator.starts import FOLLOWING_M, is_drivable, starts_along_walls
from simbridge.worlds.geometry import Edge, Point, edges_of, is_convex, polygons_of, rectangle
from simbridge.worlds.obstacle_settings import PolygonObstacleSettings, WallSettings
from simbridge.worlds.world_settings import WorldSettings

_LEAST_STARTS = 8
_LEAST_CUTS = 2
_TRIES = 40


_SHORTEST_WALL_M = 0.3
"""Least wall length; shorter ones fall between two sensors."""
_ISLAND_M = 1.2
"""Least distance from an island to other walls; a follower 0.2 m from its wall sees 0.6 m far and would switch over."""
_LEAST_SEEN = 0.75
"""Least free fraction of a wall or table; the rest may be inside the wall that it leans on."""


class RoomPlan:
    """Outline, walls and tables of a random room under construction; it refuses what blocks the way."""

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


def room(seed: int) -> WorldSettings:
    """Return the room of a seed, with convex and concave corners and a spur wall to turn back at."""
    name = f"rooms-{seed}"
    attempt = 0
    while True:
        rng = SeededRandom(f"{name}, attempt {attempt}")
        plan = RoomPlan(rng.length_m(3.2, 5.0), rng.length_m(3.2, 4.6))
        if _furnish(plan, rng):
            starts = starts_along_walls(plan.floor, rng)
            if len(starts) >= _LEAST_STARTS:
                break
        attempt += 1
    return WorldSettings(
        name=name,
        size_m=(plan.width_m, plan.height_m),
        infrared_rays=1,
        outline=plan.corners,
        walls=tuple(plan.walls),
        polygon_obstacles=tuple(plan.tables),
        start_poses=starts,
    )


def _furnish(plan: RoomPlan, rng: SeededRandom) -> bool:
    """Cut the outline, add walls and tables; return False if the room is too plain."""
    cuts = 0
    wanted = _LEAST_CUTS + rng.integer(3)
    for _ in range(_TRIES):
        cuts += plan.cut(_cut(plan, rng))
        if cuts == wanted:
            break
    if (
        cuts < _LEAST_CUTS
        or is_convex(plan.corners[:-1])
        or not any(plan.stand(_spur_wall(plan, rng)) for _ in range(_TRIES))
    ):
        return False
    if rng.chance(0.5):
        any(plan.stand(_moved_wall(plan, rng)) for _ in range(_TRIES))
    for i in range(rng.integer(3)):
        any(plan.lay(_table(plan, rng, f"table-{i + 1}")) for _ in range(_TRIES))
    return True


def _cut(plan: RoomPlan, rng: SeededRandom) -> tuple[Point, ...]:
    """Return a rectangular or slanted polygon at a corner or a side."""
    side = rng.integer(4)
    side_m = plan.width_m if side % 2 == 0 else plan.height_m
    long_m, deep_m = rng.length_m(0.5, 1.4), rng.length_m(0.3, 1.1)
    kind = rng.choice(("boxed corner", "slanted corner", "box", "wedge"))
    out_m = 0.1  # beyond the outline, so that no chink stays
    if kind == "boxed corner":
        shape = [(-out_m, -out_m), (long_m, -out_m), (long_m, deep_m), (-out_m, deep_m)]
    elif kind == "slanted corner":
        share = out_m / long_m
        shape = [(-out_m, -out_m), (long_m + out_m, -share * deep_m), (-out_m, deep_m * (1 + share))]
    else:
        begin_m = rng.length_m(0.4, max(0.4, side_m - long_m - 0.4))
        lean_m = 0.0 if kind == "box" else rng.length_m(0.15, 0.6)
        end_m = begin_m + long_m + (0.0 if kind == "box" else rng.length_m(0.15, 0.6))
        shape = [(begin_m, 0.0), (end_m, 0.0), (begin_m + lean_m + 0.6 * long_m, deep_m), (begin_m + lean_m, deep_m)]
        if kind == "box":
            shape = [(begin_m, -out_m), (end_m, -out_m), (end_m, deep_m), (begin_m, deep_m)]
    return tuple(_from_side(plan, side, along_m, in_m) for along_m, in_m in shape)


def _from_side(plan: RoomPlan, side: int, along_m: float, in_m: float) -> Point:
    """Return the point at a distance along a side, counter-clockwise from below, and at a depth into the room."""
    return (
        (along_m, in_m),
        (plan.width_m - in_m, along_m),
        (plan.width_m - along_m, plan.height_m - in_m),
        (in_m, plan.height_m - along_m),
    )[side]


def _spur_wall(plan: RoomPlan, rng: SeededRandom) -> WallSettings:
    """Return a spur wall from the outline into the room."""
    return _leaning(plan, rng, "tongue", rng.length_m(0.8, 1.8))


def _moved_wall(plan: RoomPlan, rng: SeededRandom) -> WallSettings:
    """Return a wall that leans on another, or one shifted off it into the room."""
    wall = _leaning(plan, rng, "moved-wall", rng.length_m(0.5, 1.2))
    if rng.chance(0.5):
        return wall
    return wall.moved(rng.length_m(-1.5, 1.5), rng.length_m(-1.5, 1.5))


def _leaning(plan: RoomPlan, rng: SeededRandom, name: str, length_m: float) -> WallSettings:
    edge = rng.choice(plan.edges(1.2))
    at = _along(edge, (0.25, 0.75), rng)
    inwards_rad = math.atan2(edge[1][1] - edge[0][1], edge[1][0] - edge[0][0]) + math.pi / 2
    inwards_rad += math.radians(rng.choice((0, 0, -15, -10, 10, 15)))
    return WallSettings(
        name=name,
        from_m=_beyond(at, -0.03, inwards_rad),
        to_m=_beyond(at, length_m, inwards_rad),
        thickness_m=rng.length_m(0.06, 0.1),
    )


def _table(plan: RoomPlan, rng: SeededRandom, name: str) -> PolygonObstacleSettings:
    """Return a box at a wall or anywhere."""
    long_m, deep_m = rng.length_m(0.4, 1.0), rng.length_m(0.4, 0.8)
    if rng.chance(0.6):
        edge = rng.choice(plan.edges(0.8))
        heading_rad = math.atan2(edge[1][1] - edge[0][1], edge[1][0] - edge[0][0])
        centre = _beyond(_along(edge, (0.0, 1.0), rng), deep_m / 2 - 0.02, heading_rad + math.pi / 2)
    else:
        heading_rad = math.radians(15 * rng.integer(6))
        centre = rng.length_m(0.0, plan.width_m), rng.length_m(0.0, plan.height_m)
    corners = rectangle(centre, long_m, deep_m, heading_rad)
    return PolygonObstacleSettings(name=name, corners=tuple((round(x, 2), round(y, 2)) for x, y in corners))


def _along(edge: Edge, shares: tuple[float, float], rng: SeededRandom) -> Point:
    (ax, ay), (bx, by) = edge
    share = shares[0] + (shares[1] - shares[0]) * rng.integer(101) / 100
    return ax + share * (bx - ax), ay + share * (by - ay)


def _beyond(at: Point, length_m: float, heading_rad: float) -> Point:
    return round(at[0] + length_m * math.cos(heading_rad), 2), round(at[1] + length_m * math.sin(heading_rad), 2)
