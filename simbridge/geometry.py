"""Plane geometry of walls: distances, crossings and which side of a polygon a point lies on. All in metres."""

import math
from collections.abc import Sequence

Point = tuple[float, float]
Edge = tuple[Point, Point]


def edges_of(corners: Sequence[Point]) -> list[Edge]:
    """Edges of a polygon given by its corners, the one back to the first corner included."""
    return [(corners[i - 1], corners[i]) for i in range(1, len(corners))] + [(corners[-1], corners[0])]


def signed_area_m2(corners: Sequence[Point]) -> float:
    """Area of a polygon, positive when its corners run counter-clockwise."""
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in edges_of(corners)) / 2


def is_convex(corners: Sequence[Point]) -> bool:
    """True when every corner turns the same way."""
    turns = [
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
        for a, b, c in zip(corners, (*corners[1:], corners[0]), (*corners[2:], *corners[:2]), strict=True)
    ]
    return all(turn > 0 for turn in turns) or all(turn < 0 for turn in turns)


def contains(corners: Sequence[Point], point: Point) -> bool:
    """True when the point lies inside the polygon (even-odd rule)."""
    x, y = point
    inside = False
    for (ax, ay), (bx, by) in edges_of(corners):
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            inside = not inside
    return inside


def point_distance_m(point: Point, edge: Edge) -> float:
    """Distance of a point from an edge."""
    (ax, ay), (bx, by) = edge
    dx, dy = bx - ax, by - ay
    length2 = dx * dx + dy * dy
    share = 0.0 if length2 == 0 else min(1.0, max(0.0, ((point[0] - ax) * dx + (point[1] - ay) * dy) / length2))
    return math.hypot(point[0] - ax - share * dx, point[1] - ay - share * dy)


def edges_cross(one: Edge, other: Edge) -> bool:
    """True when two edges share a point."""
    (a, b), (c, d) = one, other
    sides = (_side(c, d, a), _side(c, d, b), _side(a, b, c), _side(a, b, d))
    if sides[0] * sides[1] < 0 and sides[2] * sides[3] < 0:
        return True
    return edge_ends_distance_m(one, other) < 1e-9


def edge_ends_distance_m(one: Edge, other: Edge) -> float:
    """Least distance of either edge's ends from the other edge."""
    return min(
        point_distance_m(one[0], other),
        point_distance_m(one[1], other),
        point_distance_m(other[0], one),
        point_distance_m(other[1], one),
    )


def edge_distance_m(one: Edge, other: Edge) -> float:
    """Distance between two edges; 0 where they cross."""
    return 0.0 if edges_cross(one, other) else edge_ends_distance_m(one, other)


def rectangle(centre: Point, length_m: float, width_m: float, heading_rad: float) -> tuple[Point, Point, Point, Point]:
    """Corners of a rectangle, counter-clockwise from front left; length lies along the heading."""
    cos, sin = math.cos(heading_rad), math.sin(heading_rad)
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


def _side(a: Point, b: Point, point: Point) -> float:
    return (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0])
