"""Ray casting against the few faces near the robot.

The physics engine can answer this too, at four times the cost; rays are most of a simulated cycle.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from simbridge.contracts.simulation import Pose
from simbridge.robot.world import World
from simbridge.worlds.geometry import Point, edges_of
from simbridge.worlds.world_settings import WorldSettings

_MARGIN_M = 0.25
"""Extra range of cached faces, so that they serve until the robot has moved by it."""
Ray = tuple[float, float, float, float]
"""Start, ahead and left in m, and direction, ahead and left, in the frame of the body."""
_CORNER = 1e-9
"""Tolerance that keeps a ray from slipping between the two faces of a corner."""


class RayCaster:
    """Finder of the nearest wall along rays from near an origin, such as a robot's sensors.

    It caches the faces in range until the origin or a wall moves.
    """

    def __init__(self, world: World, reach_m: float) -> None:
        """Cast rays that end within `reach_m` of the origin."""
        self._world = world
        self._keep_m = reach_m + _MARGIN_M
        self._cached_world = world.settings
        self._cached_from: Point | None = None
        self._every_face = faces_of(world.settings)
        # Near faces: corner, vector to the next corner. Near posts: centre, squared radius.
        self._faces: list[tuple[float, float, float, float]] = []
        self._posts: list[tuple[float, float, float]] = []

    def set_origin(self, x_m: float, y_m: float) -> None:
        """Set the origin, the body's centre in this cycle."""
        cached = self._cached_from
        if (
            cached is None
            or self._cached_world is not self._world.settings
            or math.hypot(x_m - cached[0], y_m - cached[1]) > _MARGIN_M
        ):
            self._gather((x_m, y_m))

    def distance_m(self, x_m: float, y_m: float, along_x: float, along_y: float, farthest_m: float) -> float:
        """Return the distance in m from a point along a unit vector to the nearest wall, at most `farthest_m`."""
        return self.least_distance_m(Pose(x_m, y_m, 0.0), (1.0, 0.0), [(0.0, 0.0, along_x, along_y)], farthest_m)

    def least_distance_m(self, pose: Pose, turn: tuple[float, float], rays: Sequence[Ray], farthest_m: float) -> float:
        """Return the distance in m to the nearest hit of some rays of a robot, at most `farthest_m`.

        `turn`: cosine and sine of the heading of `pose`.
        """
        # The most expensive loop of a cycle: one call for all rays of a sensor.
        x_m, y_m, _ = pose
        cos, sin = turn
        nearest_m = farthest_m
        for ahead_m, left_m, along_ahead, along_left in rays:
            from_x_m, from_y_m = x_m + ahead_m * cos - left_m * sin, y_m + ahead_m * sin + left_m * cos
            along_x, along_y = along_ahead * cos - along_left * sin, along_ahead * sin + along_left * cos
            for corner_x, corner_y, edge_x, edge_y in self._faces:
                across = along_x * edge_y - along_y * edge_x
                if across == 0.0:
                    continue  # parallel: the ray hits the adjacent faces instead
                dx, dy = corner_x - from_x_m, corner_y - from_y_m
                away_m = (dx * edge_y - dy * edge_x) / across
                if 0.0 <= away_m < nearest_m and -_CORNER <= (dx * along_y - dy * along_x) / across <= 1.0 + _CORNER:
                    nearest_m = away_m
            for centre_x, centre_y, radius2 in self._posts:
                dx, dy = centre_x - from_x_m, centre_y - from_y_m
                along_m = dx * along_x + dy * along_y
                half_chord2 = radius2 - (dx * dx + dy * dy - along_m * along_m)
                if along_m > 0.0 and half_chord2 >= 0.0:
                    nearest_m = min(nearest_m, max(0.0, along_m - math.sqrt(half_chord2)))
        return nearest_m

    def _gather(self, centre: Point) -> None:
        world = self._world.settings
        if self._cached_world is not world:
            self._every_face = faces_of(world)
        # Vectorised: a map may have thousands of faces, and this cycle has no extra time.
        corner_x, corner_y, edge_x, edge_y = self._every_face.T
        dx, dy = centre[0] - corner_x, centre[1] - corner_y
        along = np.clip((dx * edge_x + dy * edge_y) / (edge_x * edge_x + edge_y * edge_y), 0.0, 1.0)
        away_x, away_y = dx - along * edge_x, dy - along * edge_y
        near_enough = away_x * away_x + away_y * away_y <= self._keep_m * self._keep_m
        near: list[list[float]] = self._every_face[near_enough].tolist()
        self._faces = [(x, y, along_x, along_y) for x, y, along_x, along_y in near]
        self._posts = [
            (post.x_m, post.y_m, post.radius_m * post.radius_m)
            for post in world.round_obstacles
            if math.dist(centre, (post.x_m, post.y_m)) - post.radius_m <= self._keep_m
        ]
        self._cached_world = world
        self._cached_from = centre


def faces_of(world: WorldSettings) -> NDArray[np.float64]:
    """Return the faces of a world's walls and boxes in m, (n, 4).

    A face has x and y of a corner, and the vector to the next corner.
    """
    edges = edges_of(world.outline[:-1]) + [edge for solid in world.solids for edge in edges_of(solid)]
    return np.array([(a[0], a[1], b[0] - a[0], b[1] - a[1]) for a, b in edges])
