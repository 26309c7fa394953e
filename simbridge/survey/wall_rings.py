"""Closed paths along the walls of a room: one inside the outer wall, one round each island.

Distances are those of KURT2. For a narrower robot the world is enlarged until the robot is as wide as KURT2.
"""

import math
from typing import NamedTuple

import numpy as np
import shapely
from shapely import affinity

from hal.numerics import cos_sin
from simbridge.worlds.geometry import Point, polygons_of
from simbridge.worlds.world_settings import WorldSettings

_ROBOT_M = 0.15
"""Distance from the robot's centre to its side less 15 mm, a lower bound of its distance to a wall."""
_WALL_M = 0.35
"""Distance from a wall follower's centre to its wall: 0.185 m from its side sensors."""
_SLIT_M = 0.005
"""Width of the slits that buffers with few corners leave between touching shapes."""
_NEAR_M = 0.3
"""Range of a ring; at 0.65 m from a wall the sensors hardly see the wall."""
_AGAINST_M = 0.1
"""Extra cost of a ring across the robot's heading; twice as much against the heading."""
_KEPT_M = 0.05
"""Bonus of the ring that the robot already follows."""
_STRETCH_M = 0.3
"""Longest movement between two updates."""
_MARGIN_M = 0.25
"""Extra range of cached faces, so that they serve until the robot has moved by it."""

Ring = shapely.LinearRing


class RingPlace(NamedTuple):
    """Place that a robot follows on a ring of walls, by which its laps are measured."""

    ring: int
    """Index of the ring; 0 is the outer wall's."""
    along_m: float
    """Arc length from the first corner of the ring, 0 to its length."""


class WallRings:
    """Rings along the walls of one room, the outer wall first, and the search for a robot's place on them."""

    def __init__(self, world: WorldSettings, position: Point, scale: float = 1.0) -> None:
        """Survey the room of `world` that contains `position`, in m, or is closest to it.

        `scale`: width of the robot as a multiple of KURT2's. All positions, also this one, are divided by it.
        """
        self.room = _room_of(world, position, scale)
        """Positions of the robot's centre in this room; its holes are the islands."""
        self.rings = [_outer_ring(self.room), *(_island_ring(hole) for hole in self.room.interiors)]
        self.lengths_m = [float(ring.length) for ring in self.rings]
        shapely.prepare(self.room)
        corners = [shapely.get_coordinates(ring) for ring in self.rings]
        steps = [np.diff(each, axis=0) for each in corners]
        steps_m = [np.sqrt(np.square(each).sum(axis=1)) for each in steps]
        self._faces = np.concatenate(
            [
                np.column_stack(
                    [xy[:-1], step / step_m[:, None], step_m, np.cumsum(step_m) - step_m, np.full_like(step_m, i)]
                )
                for i, (xy, step, step_m) in enumerate(zip(corners, steps, steps_m, strict=True))
            ]
        )
        """(n, 7): corner x, y; unit vector x, y; length; arc length at the corner, all in m; index of the ring."""
        self._near: list[list[float]] = []
        self._gathered_at: Point | None = None

    def contains(self, position: Point) -> bool:
        """Return whether the robot's centre can be at `position` in this room."""
        return bool(shapely.contains_xy(self.room, *position))

    def place(self, x_m: float, y_m: float, heading_rad: float, followed: RingPlace | None) -> RingPlace | None:
        """Return the place that a robot at this pose follows, or None if no ring is within 0.3 m.

        The closest ring wins. If two stretches are about as close, as in a narrow passage, the robot's heading decides:
        it follows the stretch that has its wall on the robot's left. The stretch next to `followed`, the last place, is
        preferred by 5 cm. Position in m, heading in rad.
        """
        gathered_at = self._gathered_at
        if gathered_at is None or math.dist((x_m, y_m), gathered_at) > _MARGIN_M:
            self._gather(x_m, y_m)
        ahead_x, ahead_y = cos_sin(heading_rad)
        best, least_m = None, math.inf
        followed_ring, followed_m = (-1, 0.0) if followed is None else followed
        for corner_x, corner_y, along_x, along_y, face_m, before_m, ring in self._near:
            dx, dy = x_m - corner_x, y_m - corner_y
            on_face_m = dx * along_x + dy * along_y
            if on_face_m < 0.0:
                on_face_m = 0.0
            elif on_face_m > face_m:
                on_face_m = face_m
            away_m = math.hypot(dx - on_face_m * along_x, dy - on_face_m * along_y)
            if away_m > _NEAR_M:
                continue
            cost_m = away_m + _AGAINST_M * (1.0 - along_x * ahead_x - along_y * ahead_y)
            if cost_m - _KEPT_M >= least_m:
                continue  # also if it were next to the last place
            if ring == followed_ring:
                moved_m = math.remainder(before_m + on_face_m - followed_m, self.lengths_m[followed_ring])
                cost_m -= _KEPT_M if abs(moved_m) <= _STRETCH_M else 0.0
            if cost_m < least_m:
                best, least_m = (ring, before_m + on_face_m), cost_m
        return None if best is None else RingPlace(int(best[0]), best[1])

    def _gather(self, x_m: float, y_m: float) -> None:
        """Keep the faces that matter until the robot has gone 0.25 m."""
        corner_x, corner_y, along_x, along_y, face_m = self._faces.T[:5]
        dx, dy = x_m - corner_x, y_m - corner_y
        on_face_m = np.clip(dx * along_x + dy * along_y, 0.0, face_m)
        away_m = np.hypot(dx - on_face_m * along_x, dy - on_face_m * along_y)
        self._near = self._faces[away_m <= _NEAR_M + _MARGIN_M].tolist()
        self._gathered_at = x_m, y_m


def _room_of(world: WorldSettings, position: Point, scale: float) -> shapely.Polygon:
    free = world.free_space
    if scale != 1.0:
        free = affinity.scale(free, 1.0 / scale, 1.0 / scale, origin=(0.0, 0.0))
    parts = polygons_of(free.buffer(-_ROBOT_M, quad_segs=2))
    centre = shapely.Point(position)
    return min(parts, key=lambda part: float(part.distance(centre)))


def _outer_ring(room: shapely.Polygon) -> Ring:
    """Return the clockwise path along the outer wall, in one piece.

    The path is 0.35 m from the wall. A passage narrower than 0.70 m between two parts of the room belongs to it: there
    the path is as close to both walls as the body allows. Other narrow places are left out.
    """
    whole = shapely.Polygon(room.exterior)
    parts = polygons_of(whole.buffer(_ROBOT_M - _WALL_M, quad_segs=2))
    way = whole if not parts else parts[0]
    if len(parts) > 1:
        reach_m = _WALL_M - _ROBOT_M + _SLIT_M
        opened = [part.buffer(reach_m) for part in parts]
        narrow = np.array(polygons_of(whole.difference(shapely.union_all(opened))), dtype=object)
        touching, _ = shapely.STRtree(opened).query(narrow, predicate="dwithin", distance=_SLIT_M)
        passages = narrow[np.bincount(touching, minlength=len(narrow)) > 1]
        joins = shapely.intersection(shapely.buffer(passages, reach_m + _SLIT_M), whole)
        joined = shapely.union_all([*parts, *joins])
        way = joined if isinstance(joined, shapely.Polygon) else whole
    ring = shapely.remove_repeated_points(way.exterior, 1e-6)
    return ring.reverse() if ring.is_ccw else ring


def _island_ring(hole: Ring) -> Ring:
    """Return the counter-clockwise path round an island."""
    ring = shapely.remove_repeated_points(shapely.Polygon(hole).buffer(_WALL_M - _ROBOT_M, quad_segs=2).exterior, 1e-6)
    return ring if ring.is_ccw else ring.reverse()
