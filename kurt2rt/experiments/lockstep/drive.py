"""One drive of a lesson or an exam, watched from above."""

import math
import random

from behaviors.metrics.task_metric import RouteMetric
from hal.simulation import Simulation
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.stuck_detector import StuckDetector


class Drive:
    """Shows the course where the robot is, measures the way it makes, and reaches in where that is needed."""

    def __init__(
        self, simulation: Simulation, task: TaskSettings, *, no_way_s: float, period_s: float, chance: random.Random
    ) -> None:
        """`no_way_s`: how long a robot may stay about where it is. `chance` decides what the course and a hand do."""
        self.course = task.course.build(simulation, task.behaviours, chance)
        self.way_m = 0.0
        """Way made on its own wheels."""
        self.repositions = 0
        """How often it was set down elsewhere, rescues left out."""
        self._simulation = simulation
        self._chance = chance
        self._way = StuckDetector(no_way_s, period_s, least_m=task.exam.stuck_within_m)
        if isinstance(self.course, RouteMetric):
            simulation.put(self.course.set_down_at)
        self._pose = simulation.pose
        self.course.put(self._pose)

    def follow(self) -> None:
        """One tick."""
        pose = self._simulation.pose
        self.way_m += math.hypot(pose.x_m - self._pose.x_m, pose.y_m - self._pose.y_m)
        self._pose = pose
        self.course.follow(pose)

    def makes_no_way(self, *, waits: bool) -> bool:
        """True when it stayed about where it is for too long; time in which it `waits` for its teacher does not count.

        To be asked in every tick.
        """
        if waits:
            self._way.restart()
            return False
        return self._way.none_since_window(self._simulation.position)

    def rescue(self) -> None:
        """Set it down at the nearest start pose, or on its route."""
        if isinstance(self.course, RouteMetric):
            self._simulation.put(self.course.set_down_at)
        else:
            self._simulation.rescue()
        self._put()

    def reposition(self, *, in_sight: bool = False, close: bool = False) -> None:
        """Set it down elsewhere: at some start pose, or anywhere in sight of something, also `close` to it.

        On a route it is set down there.
        """
        if isinstance(self.course, RouteMetric):
            self._simulation.put(self.course.set_down_at)
        else:
            self._simulation.reposition(self._chance, in_sight=in_sight, close=close)
        self.repositions += 1
        self._put()

    def _put(self) -> None:
        self._pose = self._simulation.pose
        self._way.restart()
        self.course.put(self._pose)
