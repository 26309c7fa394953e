"""A lesson or an exam in which the robot refuses what it is told ends with the reason, and is not measured."""

import random
from pathlib import Path

import pytest

from behaviors.metrics.task_metric import MetricSettings, TaskMetric
from behaviors.metrics.way import WaySettings
from kurt2rt.experiments.lockstep.lesson_keeping import LessonLostError
from simbridge.contracts.simulation import Simulation
from tests.experiments.helpers import examined, short_task, teach


class FlySettings(MetricSettings):
    """Wants what no task teaches."""

    def build(self, simulation: Simulation, behaviours: tuple[str, ...], chance: random.Random) -> TaskMetric:
        metric = WaySettings(kind="way").build(simulation, behaviours, chance)
        metric.behaviour = "fly"  # type: ignore[misc]
        return metric


FLYING = short_task(3.0, 0.0, 3.0).model_copy(update={"metric": FlySettings(kind="fly")})


def test_unknown_behaviour_ends_lesson_and_exam(tmp_path: Path) -> None:
    with pytest.raises(LessonLostError, match=r"lesson-1-after-0-1: .*'fly'; .*\bfly\b"):
        teach(tmp_path / "knowledge", FLYING)
    with pytest.raises(LessonLostError, match=r"exam-1: .*'fly'"):
        examined(FLYING)
