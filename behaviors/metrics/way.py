"""Metric of the travelled distance in m."""

import math
import random
from collections.abc import Sequence

from behaviors.metrics.task_metric import LEAST_SPEED_M_S, LeastSpeed, Metrics, MetricSettings, TaskMetric
from simbridge.contracts.simulation import Pose, Simulation


class WaySettings(MetricSettings):
    """Settings of the metric `way`: distance driven, in m."""

    least_speed_m_s: LeastSpeed = LEAST_SPEED_M_S
    """Mean speed below which a drive gets nowhere."""

    def least_progress(self, simulation: Simulation, duration_s: float) -> float:  # noqa: ARG002 - as in other courses
        """Return the distance in m of a drive of `duration_s`, in s, at the least speed."""
        return self.least_speed_m_s * duration_s

    def build(self, simulation: Simulation, behaviours: tuple[str, ...], chance: random.Random) -> TaskMetric:  # noqa: ARG002
        """Return the metric in a simulation. The other arguments are not used."""
        return Way(simulation.pose, behaviours[0])


class Way:
    """Distance travelled by the robot's center; turning on the spot adds none."""

    unit = "m"
    needs_reset = False

    def __init__(self, pose: Pose, behaviour: str) -> None:
        self.behaviour = behaviour
        self.progress = 0.0
        self._pose = pose

    @property
    def findings(self) -> Metrics:
        """Empty: the distance is the progress."""
        return {}

    def reset(self, pose: Pose) -> None:
        """Start at this pose without adding distance."""
        self._pose = pose

    def update(self, pose: Pose) -> None:
        """Add the distance from the pose before; call it in every tick."""
        self.progress += math.hypot(pose.x_m - self._pose.x_m, pose.y_m - self._pose.y_m)
        self._pose = pose

    def update_all(self, poses: Sequence[Pose]) -> None:
        """Update the metric with the poses of ticks in a row, as one call of `update` for each would."""
        progress, x_m, y_m = self.progress, self._pose.x_m, self._pose.y_m
        for next_x_m, next_y_m, _ in poses:
            progress += math.hypot(next_x_m - x_m, next_y_m - y_m)
            x_m, y_m = next_x_m, next_y_m
        self.progress = progress
        self._pose = poses[-1] if poses else self._pose

    def abort(self) -> None:
        """Do nothing: progress so far counts."""
