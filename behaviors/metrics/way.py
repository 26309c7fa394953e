"""Metres of way, wherever it leads."""

import math
import random

from behaviors.metrics.task_metric import LEAST_SPEED_M_S, Metrics, MetricSettings, TaskMetric
from hal.simulation import Pose, Simulation


class WaySettings(MetricSettings):
    """Way."""

    def least_progress(self, simulation: Simulation, duration_s: float) -> float:  # noqa: ARG002 - as in other courses
        """Return the way of a drive at 0.1 m/s, in m."""
        return LEAST_SPEED_M_S * duration_s

    def build(self, simulation: Simulation, behaviours: tuple[str, ...], chance: random.Random) -> TaskMetric:  # noqa: ARG002
        """The course."""
        return Way(simulation.pose, behaviours[0])


class Way:
    """Measures the way of the robot's centre; turning on the spot makes none."""

    unit = "m"
    needs_reset = False

    def __init__(self, pose: Pose, behaviour: str) -> None:
        self.behaviour = behaviour
        self.progress = 0.0
        self._pose = pose

    @property
    def findings(self) -> Metrics:
        """None."""
        return {}

    def reset(self, pose: Pose) -> None:
        """To be set down elsewhere makes no way."""
        self._pose = pose

    def update(self, pose: Pose) -> None:
        """A step further."""
        self.progress += math.hypot(pose.x_m - self._pose.x_m, pose.y_m - self._pose.y_m)
        self._pose = pose

    def abort(self) -> None:
        """What was made counts, and nothing else is."""
