"""Walls of a world in the physics engine."""

from collections.abc import Sequence

import pymunk

from simbridge.worlds.geometry import Point, edges_of, is_convex
from simbridge.worlds.world_settings import WorldSettings

ROBOT_KIND = 1
WALL_KIND = 2

WALL_FRICTION = 0.3
"""Wood on wood; our choice."""
_CONTACT_SLOP_M = 0.0005
"""Penetration depth at which a contact is stable. The default of 0.1 suits pixels."""


class World:
    """Walls and obstacles in a pymunk space without gravity; the robot's body is added from outside."""

    def __init__(self, settings: WorldSettings) -> None:
        self.settings = settings
        """Current settings, with moved walls at their new places."""
        self.space = pymunk.Space()
        self.space.collision_slop = _CONTACT_SLOP_M
        self._bodies: dict[str, pymunk.Body] = {}
        self._add_faces(self.space.static_body, settings.outline[:-1])
        for wall in settings.walls:
            self._add_shape(pymunk.Poly(self._add_body(wall.name), wall.corners))
        for box in settings.polygon_obstacles:
            body = self._add_body(box.name)
            if is_convex(box.corners):
                self._add_shape(pymunk.Poly(body, box.corners))
            else:  # pymunk would silently take the convex hull
                self._add_faces(body, box.corners)
        for post in settings.round_obstacles:
            self._add_shape(pymunk.Circle(self._add_body(post.name), post.radius_m, (post.x_m, post.y_m)))

    def move_wall(self, name: str, dx_m: float, dy_m: float) -> None:
        """Move a named wall or obstacle by an offset in m.

        Raises WorldRefusedError, which lists the names, for an unknown name.
        """
        self.settings = self.settings.moved(name, dx_m, dy_m)
        body = self._bodies[name]
        body.position = (body.position.x + dx_m, body.position.y + dy_m)
        self.space.reindex_shapes_for_body(body)

    def _add_body(self, name: str) -> pymunk.Body:
        body = pymunk.Body(body_type=pymunk.Body.STATIC)
        self._bodies[name] = body
        self.space.add(body)
        return body

    def _add_faces(self, body: pymunk.Body, corners: Sequence[Point]) -> None:
        # Radius 0 keeps the corners at those of the faces.
        for a, b in edges_of(corners):
            self._add_shape(pymunk.Segment(body, a, b, 0.0))

    def _add_shape(self, shape: pymunk.Shape) -> None:
        shape.friction = WALL_FRICTION
        shape.collision_type = WALL_KIND
        self.space.add(shape)
