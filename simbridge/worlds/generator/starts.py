"""Floor on which a robot fits, and start poses with the wall on the left."""

import math
from collections.abc import Iterator

import shapely

from simbridge.worlds.generator.seeded_random import SeededRandom
from simbridge.worlds.geometry import Edge, edges_of, polygons_of
from simbridge.worlds.world_settings import StartPoseSettings

TURNING_M = 0.33
"""Wall distance of the robot's centre for turning: half its diagonal, 0.273 m, and 6 cm for slip."""
FOLLOWING_M = 0.42
"""Wall distance in a bay that a wall follower enters and leaves, keeping its distance to the wall.

In narrower bays a plain follower takes the opposite wall for its own; the shipped worlds have wider ones.
"""
_DEEPEST_CORNER = 0.73
"""Area that a disc leaves out of a corner of 60 degrees, in squared radii."""


def is_drivable(free: shapely.Geometry, radius_m: float = TURNING_M) -> bool:
    """Return whether a robot with this radius reaches everywhere except corners, without a gap that it cannot enter."""
    centres = polygons_of(shapely.buffer(free, -radius_m, quad_segs=4))
    if len(centres) != 1:
        return False
    left_out = shapely.difference(free, centres[0].buffer(radius_m + 0.001, quad_segs=4))
    return all(part.area <= _DEEPEST_CORNER * radius_m * radius_m for part in polygons_of(left_out))


_HALF_SEEN_M = 0.24
"""Half of the wall segment seen by the four sensors of a side, 0.14 m, and its corners."""
_FARTHEST_M = 0.43
"""Distance from the wall to the robot's centre; its sensors are 0.165 m nearer."""
_APART_M = 0.45


def starts_along_walls(room: shapely.Polygon, rng: SeededRandom) -> tuple[StartPoseSettings, ...]:
    """Return clockwise poses along the outer wall with room to turn; none if no wall is long enough."""
    clear = room.buffer(-TURNING_M)
    starts: list[StartPoseSettings] = []
    for a, b in _clockwise(room):
        length_m = math.dist(a, b)
        along_m = _HALF_SEEN_M + rng.length_m(0.0, 0.2)
        while along_m <= length_m - _HALF_SEEN_M:
            start = _start(a, b, along_m / length_m, rng.length_m(TURNING_M + 0.01, _FARTHEST_M))
            at = shapely.Point(start.x_m, start.y_m)
            near = any(math.dist((start.x_m, start.y_m), (each.x_m, each.y_m)) < _APART_M for each in starts)
            if clear.contains(at) and not near:
                starts.append(start)
            along_m += _APART_M + rng.length_m(0.0, 0.5)
    return tuple(starts)


def _clockwise(room: shapely.Polygon) -> Iterator[Edge]:
    # Simplified: a wall that touches another adds corners on a straight line.
    ring = shapely.normalize(shapely.Polygon(room.exterior).simplify(0.001))  # normal is clockwise
    yield from edges_of([(float(x), float(y)) for x, y in shapely.get_coordinates(ring)[:-1]])


def _start(a: tuple[float, float], b: tuple[float, float], share: float, away_m: float) -> StartPoseSettings:
    heading_rad = math.atan2(b[1] - a[1], b[0] - a[0])
    # The edge runs clockwise, so the inside is on its right.
    return StartPoseSettings(
        x_m=round(a[0] + share * (b[0] - a[0]) + away_m * math.sin(heading_rad), 3),
        y_m=round(a[1] + share * (b[1] - a[1]) - away_m * math.cos(heading_rad), 3),
        heading_deg=round(math.degrees(heading_rad), 1),
    )
