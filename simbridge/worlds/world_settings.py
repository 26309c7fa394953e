"""Schema of `config/worlds/*.yaml`: outline, walls, obstacles, streets and start poses. Lengths in metres."""

import math
from collections.abc import Iterable
from itertools import combinations, pairwise
from typing import Annotated, Literal, Self

import shapely
from pydantic import Field, field_validator, model_validator

from config.settings import Settings
from hal.robot_settings import GeometrySettings
from simbridge.contracts.simulation import Pose
from simbridge.contracts.world_refusal import WorldRefusal, WorldRefusedError
from simbridge.worlds.geometry import Point, polygons_of, rectangle
from simbridge.worlds.obstacle_settings import (
    Coordinate,
    Corner,
    PolygonObstacleSettings,
    RoundObstacleSettings,
    WallSettings,
)

Size = Annotated[float, Field(gt=0, le=200)]

_EQUAL_M = 0.01
_EQUAL_DEG = 1.0


class StartPoseSettings(Settings):
    """Entry of a world's file for a pose at which lessons or exams may start."""

    x_m: Coordinate
    y_m: Coordinate
    heading_deg: Annotated[float, Field(ge=-180, le=180)]

    @property
    def pose(self) -> Pose:
        """Pose with the heading in radians."""
        return Pose(self.x_m, self.y_m, math.radians(self.heading_deg))


class StreetSettings(Settings):
    """Straight street between blocks by its middle line, which ends in the middle of the last junction."""

    from_m: Corner
    to_m: Corner
    width_m: Annotated[float, Field(gt=0, le=20)]


class WorldSettings(Settings):
    """Schema of `config/worlds/*.yaml`: outline, walls, obstacles, streets and starts, in m and degrees.

    The outline's corners are the inner faces of the outer walls. Generators and maps of map_server make one, too.
    """

    name: str
    size_m: tuple[Size, Size]
    infrared_rays: Literal[1, 3]
    outline: Annotated[tuple[Corner, ...], Field(min_length=4)]
    walls: tuple[WallSettings, ...] = ()
    round_obstacles: tuple[RoundObstacleSettings, ...] = ()
    polygon_obstacles: tuple[PolygonObstacleSettings, ...] = ()
    streets: tuple[StreetSettings, ...] = ()
    """Streets for metrics; nothing is built from them."""
    start_poses: Annotated[tuple[StartPoseSettings, ...], Field(min_length=1)]

    @field_validator("outline")
    @classmethod
    def _is_a_simple_closed_polygon(cls, outline: tuple[Corner, ...]) -> tuple[Corner, ...]:
        if outline[0] != outline[-1]:
            raise ValueError(f"not closed (last corner {outline[-1]}, first {outline[0]}); repeat the first corner")
        for corner, following in pairwise(outline):
            if corner == following:
                raise ValueError(f"corner {corner} is repeated; leave one out")
        polygon = shapely.Polygon(outline)
        if not polygon.is_valid:
            raise ValueError(f"intersects or touches itself: {shapely.is_valid_reason(polygon)}")
        return outline

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        for axis, size_m in enumerate(self.size_m):
            values = [corner[axis] for corner in self.outline]
            if abs(min(values)) > 1e-9 or abs(max(values) - size_m) > 1e-9:
                raise ValueError(f"outline must span 0 to {size_m} in {'xy'[axis]} (size_m)")
        names = self.names
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ValueError(f"duplicate name of walls or obstacles: {', '.join(twice)}")
        room = shapely.Polygon(self.outline)
        for name, shape in zip(names, self.shapes, strict=True):
            # Most walls cross the outline, against which they stand.
            if room.intersection(shape).area == 0:
                raise ValueError(f"{name} stands outside the outline; move it inside, or leave it out")
        for (i, one), (k, other) in combinations(enumerate(self.start_poses), 2):
            turn_deg = abs(math.remainder(one.heading_deg - other.heading_deg, 360.0))
            if math.dist((one.x_m, one.y_m), (other.x_m, other.y_m)) < _EQUAL_M and turn_deg < _EQUAL_DEG:
                raise ValueError(f"start_poses.{i} and start_poses.{k} are equal; leave one out")
        return self

    @property
    def names(self) -> list[str]:
        """Names of all walls and obstacles."""
        return [
            *(wall.name for wall in self.walls),
            *(post.name for post in self.round_obstacles),
            *(box.name for box in self.polygon_obstacles),
        ]

    @property
    def solids(self) -> list[tuple[Point, ...]]:
        """Corners, in m, of every wall and box inside the outline."""
        return [*(wall.corners for wall in self.walls), *(box.corners for box in self.polygon_obstacles)]

    @property
    def shapes(self) -> list[shapely.Polygon]:
        """All walls and obstacles inside the outline as polygons in m, in the order of `names`."""
        posts = [shapely.Point(post.x_m, post.y_m).buffer(post.radius_m) for post in self.round_obstacles]
        walls, boxes = self.walls, self.polygon_obstacles
        return [
            *(shapely.Polygon(wall.corners) for wall in walls),
            *posts,
            *(shapely.Polygon(box.corners) for box in boxes),
        ]

    @property
    def free_space(self) -> shapely.Polygon | shapely.MultiPolygon:
        """Area within the outline without walls and obstacles, in m, in one or several pieces."""
        free = shapely.Polygon(self.outline).difference(shapely.union_all(self.shapes))
        # If sides only touch, the difference may contain lines.
        return free if isinstance(free, shapely.Polygon) else shapely.MultiPolygon(polygons_of(free))

    @property
    def junctions(self) -> list[Point]:
        """Crossings of streets in m, by x, then by y."""
        lines = [shapely.LineString([street.from_m, street.to_m]) for street in self.streets]
        places = [one.intersection(other) for one, other in combinations(lines, 2)]
        # Rounded, because three streets that meet form three pairs.
        return sorted({(round(at.x, 6), round(at.y, 6)) for at in places if isinstance(at, shapely.Point) and at})

    def moved(self, name: str, dx_m: float, dy_m: float) -> Self:
        """Return a copy with one named wall or obstacle moved. Raises WorldRefusedError that lists the names."""
        if name not in self.names:
            raise WorldRefusedError(WorldRefusal.NO_WALL, world=self.name, name=name, known=tuple(self.names))
        return self.model_copy(
            update={
                kind: tuple(part.moved(dx_m, dy_m) if part.name == name else part for part in getattr(self, kind))
                for kind in ("walls", "round_obstacles", "polygon_obstacles")
            }
        )

    def clearance_m(self, pose: Pose, geometry: GeometrySettings) -> float:
        """Return the distance in m from the body to the nearest wall; 0 if it overlaps one or is outside."""
        return self.clearances_m([pose], geometry)[0]

    def clearances_m(self, poses: Iterable[Pose], geometry: GeometrySettings) -> list[float]:
        """Return the distance in m from the body to the nearest wall at each pose; 0 if it overlaps one."""
        room = shapely.Polygon(self.outline)
        shapely.prepare(room)
        things = [room.exterior, *self.shapes]
        clear_m = []
        for pose in poses:
            body = shapely.Polygon(
                rectangle((pose.x_m, pose.y_m), geometry.outline_length_m, geometry.outline_width_m, pose.heading_rad)
            )
            clear_m.append(float(shapely.distance(body, things).min()) if room.contains(body) else 0.0)
        return clear_m
