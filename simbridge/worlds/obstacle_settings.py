"""Schema of named walls, posts and boxes inside a world. Lengths in metres."""

import math
from typing import Annotated, Self

import shapely
from pydantic import Field, field_validator, model_validator

from config.settings import Settings
from simbridge.worlds.geometry import Point, rectangle_along

Coordinate = Annotated[float, Field(ge=-200, le=200)]
Corner = tuple[Coordinate, Coordinate]


class WallSettings(Settings):
    """Straight wall with square ends; it can be moved while the robot drives."""

    name: str
    from_m: Corner
    to_m: Corner
    thickness_m: Annotated[float, Field(ge=0.02, le=1)]

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        if math.dist(self.from_m, self.to_m) < 0.01:
            raise ValueError("from_m and to_m must be at least 0.01 m apart")
        return self

    @property
    def corners(self) -> tuple[Point, ...]:
        """Corners seen from above, in m, counter-clockwise."""
        (ax, ay), (bx, by) = self.from_m, self.to_m
        length_m = math.dist(self.from_m, self.to_m)
        along = (bx - ax) / length_m, (by - ay) / length_m
        return rectangle_along(((ax + bx) / 2, (ay + by) / 2), length_m, self.thickness_m, along)

    def moved(self, dx_m: float, dy_m: float) -> Self:
        """Return a copy shifted by this many metres."""
        (ax, ay), (bx, by) = self.from_m, self.to_m
        return self.model_copy(update={"from_m": (ax + dx_m, ay + dy_m), "to_m": (bx + dx_m, by + dy_m)})


class RoundObstacleSettings(Settings):
    """Entry of a world's file for a round post."""

    name: str
    x_m: Coordinate
    y_m: Coordinate
    radius_m: Annotated[float, Field(gt=0.001, le=5)]

    def moved(self, dx_m: float, dy_m: float) -> Self:
        """Return a copy shifted by this many metres."""
        return self.model_copy(update={"x_m": self.x_m + dx_m, "y_m": self.y_m + dy_m})


class PolygonObstacleSettings(Settings):
    """Box, block or island with straight sides; it may be concave."""

    name: str
    corners: Annotated[tuple[Corner, ...], Field(min_length=3)]

    @field_validator("corners")
    @classmethod
    def _is_simple(cls, corners: tuple[Corner, ...]) -> tuple[Corner, ...]:
        polygon = shapely.Polygon(corners)
        if len(set(corners)) < len(corners) or not polygon.is_valid or polygon.area == 0:
            raise ValueError("must enclose one area, without repeated corners and crossing sides")
        return corners

    def moved(self, dx_m: float, dy_m: float) -> Self:
        """Return a copy shifted by this many metres."""
        return self.model_copy(update={"corners": tuple((x + dx_m, y + dy_m) for x, y in self.corners)})
