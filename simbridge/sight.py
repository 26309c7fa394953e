"""How far it is to the nearest wall along a ray: exact geometry over the few faces near the robot.

The physics engine can answer this too, at four times the cost; rays are most of what a simulated cycle has to pay.
"""

import math

import numpy as np
from numpy.typing import NDArray

from simbridge.geometry import Point, edges_of
from simbridge.world import World
from simbridge.world_settings import WorldSettings

_MARGIN_M = 0.25
"""Faces so much farther than any ray reaches are kept, so that they serve until the robot has gone this far."""
_CORNER = 1e-9
"""Rays through a corner must not slip between its two faces."""


class RayCaster:
    """Rays from points of the body; keeps the faces near it and looks for others once it went or a wall moved."""

    def __init__(self, world: World, reach_m: float) -> None:
        """Rays end within `reach_m` of the position that `set_origin` is given."""
        self._world = world
        self._keep_m = reach_m + _MARGIN_M
        self._seen_world = world.settings
        self._seen_from: Point | None = None
        self._every_face = _faces_of(world.settings)
        # Corner and way to the next corner of each face nearby; centre and squared radius of each post.
        self._faces: list[tuple[float, float, float, float]] = []
        self._posts: list[tuple[float, float, float]] = []

    def set_origin(self, x_m: float, y_m: float) -> None:
        """The body's centre in this cycle."""
        seen = self._seen_from
        if (
            seen is None
            or self._seen_world is not self._world.settings
            or math.hypot(x_m - seen[0], y_m - seen[1]) > _MARGIN_M
        ):
            self._gather((x_m, y_m))

    def distance_m(self, x_m: float, y_m: float, along_x: float, along_y: float, farthest_m: float) -> float:
        """Distance from a point along a unit vector to the nearest wall or obstacle, at most `farthest_m`."""
        nearest_m = farthest_m
        for corner_x, corner_y, way_x, way_y in self._faces:
            across = along_x * way_y - along_y * way_x
            if across == 0.0:
                continue  # parallel: the faces at its ends are met instead
            dx, dy = corner_x - x_m, corner_y - y_m
            away_m = (dx * way_y - dy * way_x) / across
            if 0.0 <= away_m < nearest_m and -_CORNER <= (dx * along_y - dy * along_x) / across <= 1.0 + _CORNER:
                nearest_m = away_m
        for centre_x, centre_y, radius2 in self._posts:
            dx, dy = centre_x - x_m, centre_y - y_m
            ahead_m = dx * along_x + dy * along_y
            half_chord2 = radius2 - (dx * dx + dy * dy - ahead_m * ahead_m)
            if ahead_m > 0.0 and half_chord2 >= 0.0:
                nearest_m = min(nearest_m, max(0.0, ahead_m - math.sqrt(half_chord2)))
        return nearest_m

    def _gather(self, centre: Point) -> None:
        world = self._world.settings
        if self._seen_world is not world:
            self._every_face = _faces_of(world)
        # All at once: a map may have thousands of faces, and the cycle has no more time than others.
        corner_x, corner_y, way_x, way_y = self._every_face.T
        dx, dy = centre[0] - corner_x, centre[1] - corner_y
        share = np.clip((dx * way_x + dy * way_y) / (way_x**2 + way_y**2), 0.0, 1.0)
        away_m = np.hypot(dx - share * way_x, dy - share * way_y)
        near: list[list[float]] = self._every_face[away_m <= self._keep_m].tolist()
        self._faces = [(x, y, along_x, along_y) for x, y, along_x, along_y in near]
        self._posts = [
            (post.x_m, post.y_m, post.radius_m**2)
            for post in world.round_obstacles
            if math.dist(centre, (post.x_m, post.y_m)) - post.radius_m <= self._keep_m
        ]
        self._seen_world = world
        self._seen_from = centre


def _faces_of(world: WorldSettings) -> NDArray[np.float64]:
    """Corner and way to the next corner of each face, (n, 4)."""
    edges = edges_of(world.outline[:-1]) + [edge for solid in world.solids for edge in edges_of(solid)]
    return np.array([(a[0], a[1], b[0] - a[0], b[1] - a[1]) for a, b in edges])
