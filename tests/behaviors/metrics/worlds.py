"""Courses in shipped worlds."""

import random

from behaviors.metrics.task_metric import MetricSettings, TaskMetric
from tests.experiments.helpers import STAGE


def course_in(world: str, settings: MetricSettings, behaviours: tuple[str, ...] = ("",), seed: int = 1) -> TaskMetric:
    """Return the metric at its beginning."""
    simulation = STAGE.open(world, 1, "test")
    try:
        return settings.build(simulation, behaviours, random.Random(seed))
    finally:
        simulation.close()
