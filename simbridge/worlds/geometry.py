"""Plane geometry of walls and bodies, in metres."""

import math
from collections.abc import Sequence

import shapely

Point = tuple[float, float]
Edge = tuple[Point, Point]


def edges_of(corners: Sequence[Point]) -> list[Edge]:
    """Return the edges of a polygon, including the one back to the first corner."""
    return [(corners[i - 1], corners[i]) for i in range(1, len(corners))] + [(corners[-1], corners[0])]


def is_convex(corners: Sequence[Point]) -> bool:
    """Return whether the corners, each given once, form a convex polygon."""
    polygon = shapely.Polygon(corners)
    return bool(polygon.is_valid) and len(shapely.get_coordinates(polygon.convex_hull)) == len(corners) + 1


def polygons_of(shape: shapely.Geometry) -> list[shapely.Polygon]:
    """Return the non-empty polygons of a shape, without lines and points."""
    return [part for part in shapely.get_parts(shape) if isinstance(part, shapely.Polygon) and not part.is_empty]


def rectangle(centre: Point, length_m: float, width_m: float, heading_rad: float) -> tuple[Point, Point, Point, Point]:
    """Return the corners counter-clockwise from front left; the length in m lies along the heading."""
    return rectangle_along(centre, length_m, width_m, (math.cos(heading_rad), math.sin(heading_rad)))


def rectangle_along(centre: Point, length_m: float, width_m: float, along: Point) -> tuple[Point, Point, Point, Point]:
    """Return the corners counter-clockwise from front left; the length in m lies along the unit vector `along`."""
    cos, sin = along
    x, y = centre
    half_length, half_width = length_m / 2, width_m / 2

    def corner(along: float, left: float) -> Point:
        return (x + along * cos - left * sin, y + along * sin + left * cos)

    return (
        corner(half_length, half_width),
        corner(-half_length, half_width),
        corner(-half_length, -half_width),
        corner(half_length, -half_width),
    )
