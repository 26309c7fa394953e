"""Whether a wall follower gets all round a room, judged by geometry."""

import shapely

from simbridge.geometry import polygons_of

TURNING_M = 0.33
"""From the robot's centre to a wall so that it can turn there: half its diagonal, 0.273 m, and 6 cm for its slip."""
FOLLOWING_M = 0.42
"""The same for a bay that a wall follower goes into and out of again: there it also keeps its distance from the wall.

In bays of the shipped worlds it has more; in narrower ones a plain follower takes the other side for its own."""
_DEEPEST_CORNER = 0.73
"""Of a corner of 60 degrees, a disc leaves so much of its own square radius out."""


def is_drivable(free: shapely.Geometry, radius_m: float = TURNING_M) -> bool:
    """True when the robot has this radius for itself everywhere but in corners, and gets from everywhere to everywhere.

    So no gap is there that it sees into and does not fit in.
    """
    centres = polygons_of(shapely.buffer(free, -radius_m, quad_segs=4))
    if len(centres) != 1:
        return False
    left_out = shapely.difference(free, centres[0].buffer(radius_m + 0.001, quad_segs=4))
    return all(part.area <= _DEEPEST_CORNER * radius_m**2 for part in polygons_of(left_out))
