"""Laps along the outer wall, for judging a wall follower."""

import math

from simbridge.geometry import Point, edges_of, signed_area_m2
from simbridge.world_settings import WorldSettings


class Laps:
    """Progress along the outline: the point of it nearest to the robot, followed as it wanders round.

    Positive with the wall on the left, which is clockwise. A robot far from every wall has no meaningful progress; what
    it seems to gain it loses when it comes back.
    """

    def __init__(self, world: WorldSettings) -> None:
        corners = list(world.outline[:-1])
        if signed_area_m2(corners) > 0:
            corners.reverse()
        self._edges: list[tuple[float, float, float, float, float, float]] = []
        along_m = 0.0
        for (ax, ay), (bx, by) in edges_of(corners):
            length_m = math.hypot(bx - ax, by - ay)
            self._edges.append((ax, ay, (bx - ax) / length_m, (by - ay) / length_m, length_m, along_m))
            along_m += length_m
        self.perimeter_m = along_m
        self._along_m = 0.0
        self._progress_m = 0.0

    @property
    def count(self) -> float:
        """Laps so far, with fractions."""
        return self._progress_m / self.perimeter_m

    def put(self, position: Point) -> None:
        """The robot was put here: no progress."""
        self._along_m = self._project(position)

    def follow(self, position: Point) -> None:
        """The robot came here on its own wheels, less than half a lap since the last call."""
        along_m = self._project(position)
        self._progress_m += math.remainder(along_m - self._along_m, self.perimeter_m)
        self._along_m = along_m

    def _project(self, position: Point) -> float:
        x, y = position
        nearest2, found_m = math.inf, 0.0
        for ax, ay, ux, uy, length_m, start_m in self._edges:
            dx, dy = x - ax, y - ay
            along_m = min(length_m, max(0.0, dx * ux + dy * uy))
            away2 = (dx - along_m * ux) ** 2 + (dy - along_m * uy) ** 2
            if away2 < nearest2:
                nearest2, found_m = away2, start_m + along_m
        return found_m
