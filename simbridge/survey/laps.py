"""Progress of a wall follower, measured along its wall."""

import math

from simbridge.contracts.simulation import Pose, WallSide
from simbridge.robot.world import World
from simbridge.survey.wall_rings import RingPlace, WallRings

_GATE_M = 0.02
"""Largest distance between two gates of a ring."""
_CORNER_M = 1.0
"""Largest jump in arc length that a corner explains; a longer jump crosses the room."""
_LAP_FRACTION = 0.6
"""Fraction of the ring's length after which a gate counts again."""


class WallProgress:
    """Signed progress along the walls of a room, forward with the wall on one side of the robot, by default the left.

    Each ring (`WallRings`) has gates. Passing a gate is worth the distance to the next one. A gate counts again only
    after progress of 60 % of the ring's length, or in the other direction, which takes its worth back. So driving to
    and fro between two walls counts once. Jumps across the room and between rings count nothing.
    """

    def __init__(self, world: World, scale: float = 1.0, side: WallSide = "left") -> None:
        """Survey the room of the first start pose.

        Args:
            world: walls and obstacles.
            scale: width of the robot as a multiple of KURT2's, to which all distances of the survey are fitted.
            side: side of the robot on which its wall is.
        """
        self._scale = scale
        self._forward = 1 if side == "left" else -1
        """Direction along the rings, which have their wall on the left, that counts as forward."""
        self.laps = 0.0
        """Progress in lengths of the outer wall's ring, also along an island: one unit for a room."""
        self._world = world
        start = world.settings.start_poses[0]
        self._survey(start.pose)
        self.reset(start.pose)

    @property
    def lap_m(self) -> float:
        """Length in m of the outer wall's ring."""
        return self._rings.lengths_m[0] * self._scale

    def reset(self, pose: Pose) -> None:
        """Restart at a pose after repositioning: no progress, and all gates count again."""
        scale = self._scale
        x_m, y_m = pose.x_m / scale, pose.y_m / scale
        if self._world.settings is not self._surveyed or not self._rings.contains((x_m, y_m)):
            self._survey(pose)
        self._gates = [_Gates(length_m) for length_m in self._rings.lengths_m]
        self._progress_m = 0.0
        self._place: RingPlace | None = None
        self._place = self._placed(x_m, y_m, pose.heading_rad, None)

    def update(self, x_m: float, y_m: float, heading_rad: float) -> float:
        """Apply the pose that the robot drove to, a few decimetres from the last one; return the progress in laps.

        Position in m, heading in rad.
        """
        if self._world.settings is not self._surveyed:
            # Arc lengths of the old rings mean nothing after a wall was moved.
            self.reset(Pose(x_m, y_m, heading_rad))
            return self.laps
        x_m, y_m = x_m / self._scale, y_m / self._scale
        place, last = self._placed(x_m, y_m, heading_rad, self._place), self._place
        if place is None:
            return self.laps
        if last is not None and last.ring == place.ring:
            step_m = self._gates[place.ring].pass_through(last.along_m, place.along_m, self._progress_m)
            self._progress_m += step_m
            self.laps += self._forward * step_m / self._rings.lengths_m[0]
        self._place = place
        return self.laps

    def _placed(self, x_m: float, y_m: float, heading_rad: float, followed: RingPlace | None) -> RingPlace | None:
        """Return the place on a ring that the robot follows: the wall on its right is on the left looking back."""
        ahead_rad = heading_rad if self._forward > 0 else heading_rad + math.pi
        return self._rings.place(x_m, y_m, ahead_rad, followed)

    def _survey(self, pose: Pose) -> None:
        self._surveyed = self._world.settings
        scale = self._scale
        self._rings = WallRings(self._surveyed, (pose.x_m / scale, pose.y_m / scale), scale)


class _Gates:
    """Gates of one ring, at equal distances."""

    def __init__(self, length_m: float) -> None:
        count = math.ceil(length_m / _GATE_M)
        self._length_m = length_m
        self._apart_m = length_m / count
        self._passed: list[tuple[int, float]] = [(0, 0.0)] * count
        """Per gate: direction of the last passage (0: none), and the progress at that time."""

    def pass_through(self, from_m: float, to_m: float, progress_m: float) -> float:
        """Return the progress, in m, of a step from one arc length to another.

        `progress_m`: progress on all rings before this step.
        """
        step_m = math.remainder(to_m - from_m, self._length_m)
        if abs(step_m) > _CORNER_M:
            return 0.0
        here, there = math.floor(from_m / self._apart_m), math.floor((from_m + step_m) / self._apart_m)
        direction = 1 if there > here else -1
        # Going backward, the robot passes first the gate at the begin of its own stretch.
        crossed = range(here + 1, there + 1) if direction > 0 else range(here, there, -1)
        gained_m = 0.0
        for index in crossed:
            gate = index % len(self._passed)
            passed, then_m = self._passed[gate]
            if passed != direction or abs(progress_m - then_m) >= _LAP_FRACTION * self._length_m:
                self._passed[gate] = direction, progress_m
                gained_m += direction * self._apart_m
        return gained_m
