"""Detector of a stuck robot."""

import math
from collections import deque

from hal.simulation import Position


class StuckDetector:
    """Tells a robot that stays about where it is, progress or going round in circles, from one that travels."""

    def __init__(self, window_s: float, period_s: float, *, least_m: float = 1.0) -> None:
        self._stride = round(0.5 / period_s)
        self._positions: deque[Position] = deque(maxlen=max(2, round(window_s / 0.5) + 1))
        self._least_m = least_m
        self._ticks = 0

    def none_since_window(self, position: Position) -> bool:
        """Return whether the robot stayed within `least_m` for a whole window; call it in every tick."""
        due = self._ticks % self._stride == 0
        self._ticks += 1
        if not due:
            return False
        self._positions.append(position)
        full = len(self._positions) == self._positions.maxlen
        return full and all(
            math.hypot(position.x_m - old.x_m, position.y_m - old.y_m) < self._least_m for old in self._positions
        )

    def restart(self) -> None:
        """Begin a new window."""
        self._positions.clear()
        self._ticks = 0
