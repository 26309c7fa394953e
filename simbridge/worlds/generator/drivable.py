"""Geometric check that a wall follower gets round a room."""

import shapely

from simbridge.worlds.geometry import polygons_of

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
