"""Schema of `config/worlds/*.yaml`: outline, walls, obstacles and start poses of one world. Lengths in metres."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, field_validator, model_validator

from hal.robot_settings import GeometrySettings, RobotSettings, load_robot
from hal.settings import Settings, SettingsError, find_config, load_settings
from simbridge.geometry import (
    Point,
    contains,
    edge_distance_m,
    edges_cross,
    edges_of,
    point_distance_m,
    rectangle,
)
from simbridge.obstacle_settings import (
    Coordinate,
    Corner,
    PolygonObstacleSettings,
    RoundObstacleSettings,
    WallSettings,
)
from simbridge.pose import Pose

START_CLEARANCE_M = 0.05
"""A start pose nearer to a wall than this would begin with a collision as soon as the robot turns."""

_TOUCHING_M = 1e-9
Size = Annotated[float, Field(gt=0, le=50)]


class StartPoseSettings(Settings):
    """Where a lesson or an exam may begin."""

    x_m: Coordinate
    y_m: Coordinate
    heading_deg: Annotated[float, Field(ge=-180, le=180)]

    @property
    def pose(self) -> Pose:
        """The same with the heading in radians."""
        return Pose(self.x_m, self.y_m, math.radians(self.heading_deg))


class WorldSettings(Settings):
    """One world, whole. The outline's corners are the inner faces of the outer walls."""

    name: str
    size_m: tuple[Size, Size]
    infrared_rays: Literal[1, 3]
    outline: Annotated[tuple[Corner, ...], Field(min_length=4)]
    walls: tuple[WallSettings, ...] = ()
    round_obstacles: tuple[RoundObstacleSettings, ...] = ()
    polygon_obstacles: tuple[PolygonObstacleSettings, ...] = ()
    start_poses: Annotated[tuple[StartPoseSettings, ...], Field(min_length=1)]

    @field_validator("outline")
    @classmethod
    def _is_a_simple_closed_polygon(cls, outline: tuple[Corner, ...]) -> tuple[Corner, ...]:
        if outline[0] != outline[-1]:
            raise ValueError(f"not closed: the last corner {outline[-1]} must repeat the first {outline[0]}")
        edges = edges_of(outline[:-1])
        for edge in edges:
            if edge[0] == edge[1]:
                raise ValueError(f"corner {edge[0]} stands twice in a row")
        for edge, following in zip(edges, (*edges[1:], edges[0]), strict=True):
            if min(point_distance_m(following[1], edge), point_distance_m(edge[0], following)) < _TOUCHING_M:
                raise ValueError(f"intersects itself: it turns back on itself at {edge[1]}")
        for i, edge in enumerate(edges):
            for j in range(i + 2, len(edges)):
                if (i, j) != (0, len(edges) - 1) and edges_cross(edge, edges[j]):
                    raise ValueError(f"intersects itself: {edge[0]} to {edge[1]} meets {edges[j][0]} to {edges[j][1]}")
        return outline

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        for axis, size_m in enumerate(self.size_m):
            values = [corner[axis] for corner in self.outline]
            if abs(min(values)) > 1e-9 or abs(max(values) - size_m) > 1e-9:
                raise ValueError(f"outline must span 0 to {size_m} in {'xy'[axis]}, as size_m says")
        names = self.names
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ValueError(f"two walls or obstacles share the name {', '.join(twice)}")
        return self

    @property
    def names(self) -> list[str]:
        """Names of everything that can be moved."""
        return [
            *(wall.name for wall in self.walls),
            *(post.name for post in self.round_obstacles),
            *(box.name for box in self.polygon_obstacles),
        ]

    @property
    def solids(self) -> list[tuple[Point, ...]]:
        """Corners of every wall and box inside the outline."""
        return [*(wall.corners for wall in self.walls), *(box.corners for box in self.polygon_obstacles)]

    def moved(self, name: str, dx_m: float, dy_m: float) -> Self:
        """The same world with one named wall or obstacle moved. Raises KeyError that lists the names."""
        if name not in self.names:
            raise KeyError(
                f"world {self.name}: nothing is named {name!r}; there are: {', '.join(self.names) or 'none'}"
            )
        return self.model_copy(
            update={
                kind: tuple(part.moved(dx_m, dy_m) if part.name == name else part for part in getattr(self, kind))
                for kind in ("walls", "round_obstacles", "polygon_obstacles")
            }
        )

    def clearance_m(self, pose: Pose, geometry: GeometrySettings) -> float:
        """Distance from the body at a pose to the nearest wall or obstacle; 0 when it overlaps one or is outside."""
        centre = (pose.x_m, pose.y_m)
        body = rectangle(centre, geometry.outline_length_m, geometry.outline_width_m, pose.heading_rad)
        if not contains(self.outline[:-1], centre) or any(contains(solid, centre) for solid in self.solids):
            return 0.0
        faces = edges_of(self.outline[:-1]) + [face for solid in self.solids for face in edges_of(solid)]
        # A solid wholly under the body crosses none of its sides; its corners still lie within.
        if any(contains(body, face[0]) for face in faces):
            return 0.0
        sides = edges_of(body)
        clear_m = min(edge_distance_m(side, face) for side in sides for face in faces)
        for post in self.round_obstacles:
            post_centre = (post.x_m, post.y_m)
            away_m = 0.0 if contains(body, post_centre) else min(point_distance_m(post_centre, side) for side in sides)
            clear_m = min(clear_m, max(0.0, away_m - post.radius_m))
        return clear_m


def load_world(name_or_path: str = "a", robot: RobotSettings | None = None) -> WorldSettings:
    """Settings of a shipped world by name, or of a file by path; the robot (KURT2 unless given) must fit each start.

    Raises hal.settings.SettingsError that names file and key.
    """
    path = find_config("worlds", name_or_path)
    world = load_settings(path, WorldSettings)
    geometry = (robot or load_robot()).geometry
    for i, start in enumerate(world.start_poses):
        clear_m = world.clearance_m(start.pose, geometry)
        if clear_m < START_CLEARANCE_M:
            raise SettingsError(
                f"{path}: start_poses.{i}: the robot is {clear_m:.3f} m from a wall or obstacle, "
                f"allowed is at least {START_CLEARANCE_M} m; move the pose away from it"
            )
    return world
