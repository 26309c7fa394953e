"""Distance from a position to the nearest wall or obstacle."""

import math

import shapely

from simbridge.robot.world import World
from simbridge.worlds.geometry import Point


class Clearance:
    """Distance query in a world with movable walls."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._survey()

    def distance_m(self, position: Point) -> float:
        """Return the distance in m to the nearest face; 0 inside a solid."""
        world = self._world.settings
        if world is not self._surveyed:
            self._survey()
        away_m = float(shapely.distance(self._faces, shapely.Point(position)))
        posts_m = (math.dist(position, (post.x_m, post.y_m)) - post.radius_m for post in world.round_obstacles)
        return max(0.0, min([away_m, *posts_m]))

    def _survey(self) -> None:
        world = self._surveyed = self._world.settings
        boxes = [shapely.Polygon(corners) for corners in world.solids]
        self._faces = shapely.GeometryCollection([shapely.LinearRing(world.outline), *boxes])
        shapely.prepare(self._faces)
