"""Memory of the robot's turning: how far it has turned since it last turned the other way."""

import math


class TurnMemory:
    """Signed turn since the last reversal, from the wheels' motion, in constant time and memory.

    A circling robot's turn grows round after round. In an eight left and right turns alternate, so it stays below a
    round.
    """

    def __init__(self, reversal_rad: float, fades_in_m: float = math.inf) -> None:
        """Start without a turn.

        Args:
            reversal_rad: turn the other way in rad that counts as a reversal; smaller ones are subtracted.
            fades_in_m: way in m over which an earlier turn fades to 37 %; infinite: only a reversal ends it.
        """
        self._reversal_rad = reversal_rad
        self._fades_in_m = fades_in_m
        self.restart()

    def restart(self) -> None:
        """Forget the past: the robot may have been carried elsewhere."""
        self._turned_rad = self._farthest_rad = 0.0

    def update(self, turn_rad: float, way_m: float = 0.0) -> float:
        """Add the motion of one tick; return the turn since the last reversal in rad, counter-clockwise positive.

        Args:
            turn_rad: turn in rad, counter-clockwise positive.
            way_m: way in m, forward or backward.

        The reversal begins at the farthest turn before it, so the turn of the reversal counts whole.
        """
        kept = max(0.0, 1.0 - abs(way_m) / self._fades_in_m)
        turned_rad, farthest_rad = kept * self._turned_rad + turn_rad, kept * self._farthest_rad
        back_rad = farthest_rad - turned_rad
        if farthest_rad * turned_rad <= 0.0 or abs(turned_rad) > abs(farthest_rad):
            farthest_rad = turned_rad
        elif abs(back_rad) >= self._reversal_rad:
            turned_rad = farthest_rad = -back_rad
        self._turned_rad, self._farthest_rad = turned_rad, farthest_rad
        return turned_rad
