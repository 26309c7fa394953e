"""Memory of the robot's turning: how far it has turned since it last turned the other way."""


class TurnMemory:
    """Signed turn since the last reversal, from the wheels' motion, in constant time and memory.

    A circling robot's turn grows round after round. In an eight left and right turns alternate, so it stays below a
    round.
    """

    def __init__(self, reversal_rad: float) -> None:
        """`reversal_rad`: turn the other way in rad that counts as a reversal; smaller ones are subtracted."""
        self._reversal_rad = reversal_rad
        self.restart()

    def restart(self) -> None:
        """Forget the past: the robot may have been carried elsewhere."""
        self._turned_rad = self._farthest_rad = 0.0

    def update(self, turn_rad: float) -> float:
        """Add the turn of one tick in rad, counter-clockwise positive; return the turn since the last reversal in rad.

        The reversal begins at the farthest turn before it, so the turn of the reversal counts whole.
        """
        turned_rad, farthest_rad = self._turned_rad + turn_rad, self._farthest_rad
        back_rad = farthest_rad - turned_rad
        if farthest_rad * turned_rad <= 0.0 or abs(turned_rad) > abs(farthest_rad):
            farthest_rad = turned_rad
        elif abs(back_rad) >= self._reversal_rad:
            turned_rad = farthest_rad = -back_rad
        self._turned_rad, self._farthest_rad = turned_rad, farthest_rad
        return turned_rad
