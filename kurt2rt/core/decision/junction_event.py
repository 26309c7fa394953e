"""What a robot did at a junction, as it measured it itself."""

from typing import NamedTuple

NAMES = {0: "straight", 1: "left", -1: "right", 2: "back"}
"""How the quarter turns are spoken of."""


class JunctionEvent(NamedTuple):
    """The robot has passed a junction: a side was open, now a wall stands on either side again."""

    quarters: int
    """Quarter turns to the left between the street it came from and the one it is in: 0, 1, -1 (right) or 2 (back)."""
    left_open: bool
    """Whether there was a way to the left, as it came."""
    right_open: bool
    turn_rad: float
    """How far it turned, by its encoders."""
    way_m: float
    """How far it drove from the last of the one street to where it was sure of the next."""

    @property
    def name(self) -> str:
        """straight, left, right or back."""
        return NAMES[self.quarters]
