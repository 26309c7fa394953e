"""Distance from a position to the nearest wall or obstacle."""

import math
from collections.abc import Sequence

import shapely

from simbridge.robot.world import World
from simbridge.worlds.geometry import Point


class Clearance:
    """Distance query in a world with movable walls."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._survey()

    def distances_m(self, positions: Sequence[Point]) -> list[float]:
        """Return the distance in m from each position to the nearest face; 0 inside a solid."""
        if not positions:
            return []
        world = self._world.settings
        if world is not self._surveyed:
            self._survey()
        if not positions:
            return []  # shapely makes no points of nothing
        away_m: list[float] = shapely.distance(self._faces, shapely.points(positions)).tolist()
        if not world.round_obstacles:
            return [max(0.0, each) for each in away_m]
        posts = world.round_obstacles
        return [
            max(0.0, min([each, *(math.dist(at, (post.x_m, post.y_m)) - post.radius_m for post in posts)]))
            for each, at in zip(away_m, positions, strict=True)
        ]

    def _survey(self) -> None:
        world = self._surveyed = self._world.settings
        boxes = [shapely.Polygon(corners) for corners in world.solids]
        self._faces = shapely.GeometryCollection([shapely.LinearRing(world.outline), *boxes])
        shapely.prepare(self._faces)
