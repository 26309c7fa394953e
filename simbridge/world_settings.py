"""Schema of `config/worlds/*.yaml`: outline, walls, obstacles and start poses of one world. Lengths in metres."""

import math
from itertools import pairwise
from typing import Annotated, Literal, Self

import shapely
from pydantic import Field, field_validator, model_validator

from hal.robot_settings import GeometrySettings, RobotSettings, load_robot
from hal.settings import Settings, SettingsError, find_config, load_settings
from simbridge.geometry import Point, rectangle
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
        for corner, following in pairwise(outline):
            if corner == following:
                raise ValueError(f"corner {corner} stands twice in a row")
        polygon = shapely.Polygon(outline)
        if not polygon.is_valid:
            raise ValueError(f"intersects or touches itself: {shapely.is_valid_reason(polygon)}")
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
        corners = rectangle((pose.x_m, pose.y_m), geometry.outline_length_m, geometry.outline_width_m, pose.heading_rad)
        body, room = shapely.Polygon(corners), shapely.Polygon(self.outline)
        if not room.contains(body):
            return 0.0
        clear_m: float = body.distance(room.exterior)
        for solid in self.solids:
            clear_m = min(clear_m, body.distance(shapely.Polygon(solid)))
        for post in self.round_obstacles:
            clear_m = min(clear_m, body.distance(shapely.Point(post.x_m, post.y_m)) - post.radius_m)
        return max(0.0, clear_m)


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
