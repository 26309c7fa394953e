"""Areas of a world along its axes, such as junctions of streets, at whose borders another behaviour may be wanted."""

from typing import NamedTuple


class Area(NamedTuple):
    """Rectangle of a world, such as a junction, whose edges run along the axes; lengths in m."""

    x_m: float
    """Centre."""
    y_m: float
    half_width_m: float
    """Half of its extent in x."""
    half_height_m: float
    """Half of its extent in y."""


def holds(x_m: float, y_m: float, area: Area, margin_m: float) -> bool:
    """Return whether a position in m lies in an area, or at most `margin_m` outside."""
    # No `and`, so that arrays of positions and areas can be given as well.
    inside_x = abs(x_m - area.x_m) <= area.half_width_m + margin_m
    return inside_x & (abs(y_m - area.y_m) <= area.half_height_m + margin_m)


class Borders(NamedTuple):
    """Borders at which another behaviour may be wanted of a robot.

    A robot that is in no area enters the first one that holds it; it is in that one until it has left it.
    """

    every_ticks: int
    """Ticks from one look at the robot's position to the next; the first tick counts."""
    margin_m: float
    """Distance outside of an area beyond which a robot has left it."""
    areas: tuple[Area, ...]
