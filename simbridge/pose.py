"""Where the robot is and which way it looks."""

from typing import NamedTuple


class Pose(NamedTuple):
    """Centre of the body in the world's frame; heading counter-clockwise from the x axis, not wrapped."""

    x_m: float
    y_m: float
    heading_rad: float
