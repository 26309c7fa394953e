"""Junction event: a passed junction, as the robot measured it."""

from typing import NamedTuple

NAMES = {0: "straight", 1: "left", -1: "right", 2: "back"}
"""Names of the quarter turns."""


class JunctionEvent(NamedTuple):
    """Passed junction: a side was open, and now there are walls on both sides again."""

    quarters: int
    """Quarter turns to the left between the street it came from and the one it is in: 0, 1, -1 (right) or 2 (back)."""
    left_open: bool
    """True if there was a way to the left of the street it came from."""
    right_open: bool
    turn_rad: float
    """Angle by the encoders, in rad; positive to the left."""
    way_m: float
    """Distance from the end of the one street to the certain detection of the next, in m."""

    @property
    def name(self) -> str:
        """Return straight, left, right or back."""
        return NAMES[self.quarters]
