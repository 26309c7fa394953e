"""Guide of a robot in a batch, on a metric that wants another behaviour, or puts the robot elsewhere, at borders."""

import random

from behaviors.metrics.task_metric import BorderMetric
from hal.batch import Batch, FollowedSimulation
from hal.simulation import Pose


class BatchGuide:
    """Guide of one robot, which stops at the borders of its metric."""

    def __init__(self, simulation: FollowedSimulation, metric: BorderMetric, chance: random.Random) -> None:
        """`metric`: knows the poses up to the newest one. `chance`: of the metric."""
        self._simulation, self._metric, self._chance = simulation, metric, chance

    def begin(self, batch: Batch, robot: int) -> None:
        """Let a robot that has not driven yet stop at borders, and drive by the behaviour that is wanted."""
        batch.watch(robot, self._metric.borders)
        batch.select(robot, self._metric.behaviour)

    def look_after(self, batch: Batch, robot: int) -> Pose | None:
        """Do in the newest tick as the metric says; return the pose in m and rad at which the robot was put, if so."""
        put: Pose | None = None
        if self._metric.needs_reset:
            put = self._simulation.draw_pose(self._chance, in_sight=False)
            batch.put(robot, put)
            self._simulation.carry(put)
            self._metric.reset(put)
        batch.select(robot, self._metric.behaviour)
        return put
