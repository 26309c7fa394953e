"""Whether a wall follower gets all round a room, judged by geometry."""

import shapely

from simbridge.geometry import polygons_of

TURNING_M = 0.33
"""From the robot's centre to a wall so that it can turn there: half its diagonal, 0.273 m, and 6 cm for its slip."""
_DEEPEST_CORNER_M2 = 0.08
"""A disc of that radius leaves so much of a corner of 60 degrees out."""


def is_drivable(free: shapely.Geometry) -> bool:
    """True when the robot can turn everywhere but in corners, and gets from everywhere to everywhere.

    So no gap is there that it sees into and does not fit in.
    """
    centres = polygons_of(shapely.buffer(free, -TURNING_M, quad_segs=4))
    if len(centres) != 1:
        return False
    left_out = shapely.difference(free, centres[0].buffer(TURNING_M + 0.001, quad_segs=4))
    return all(part.area <= _DEEPEST_CORNER_M2 for part in polygons_of(left_out))
