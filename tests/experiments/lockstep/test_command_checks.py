"""A lesson or an exam in which the robot refuses what it is told ends with the reason, and is not measured."""

import random
from pathlib import Path

import anyio
import pytest
import yaml

from behaviors.metrics.task_metric import MetricSettings, TaskMetric
from behaviors.metrics.way import WaySettings
from config import CONFIG_DIR
from kurt2rt.core.decision.decision import UnknownActionError
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import run_exams
from kurt2rt.experiments.lockstep.lesson_keeping import LessonLostError
from simbridge.contracts.simulation import Simulation
from tests.experiments.helpers import ROBOT, STAGE, short_task, teach


def without(tmp_path: Path, *actions: str) -> TaskSettings:
    """Return a short task whose repertoire lacks these actions."""
    content = yaml.safe_load((CONFIG_DIR / "repertoires" / "basic.yaml").read_text(encoding="utf-8"))
    content["actions"] = [each for each in content["actions"] if each["name"] not in actions]
    file = tmp_path / "small.yaml"
    file.write_text(yaml.safe_dump(content), encoding="utf-8")
    return short_task(3.0, 0.0, 3.0).model_copy(update={"repertoire": str(file)})


def examined(task: TaskSettings) -> None:
    async def exams() -> None:
        await run_exams(STAGE, ROBOT, task, [], ("a",), seed=1, report=lambda *_: None)

    anyio.run(exams)


class FlySettings(MetricSettings):
    """Wants what no task teaches."""

    def build(self, simulation: Simulation, behaviours: tuple[str, ...], chance: random.Random) -> TaskMetric:
        metric = WaySettings(kind="way").build(simulation, behaviours, chance)
        metric.behaviour = "fly"  # type: ignore[misc]
        return metric


FLYING = short_task(3.0, 0.0, 3.0).model_copy(update={"metric": FlySettings(kind="fly")})


def test_an_answer_that_the_repertoire_lacks_ends_the_lesson(tmp_path: Path) -> None:
    task = without(tmp_path, "forward", "along_left_wall", "curve_left")
    with pytest.raises(
        LessonLostError,
        match=r"task wall_following, tick \d+: .*lesson-1-after-0-1: .*'\w+'; .*: bear_left, .*small\.yaml",
    ):
        teach(tmp_path / "knowledge", task)


def test_teacher_policy_names_an_unknown_action(tmp_path: Path) -> None:
    task = without(tmp_path, "forward", "along_left_wall", "curve_left")
    with pytest.raises(UnknownActionError, match=r"'\w+', .*: bear_left, "):
        examined(task)


def test_unknown_behaviour_ends_lesson_and_exam(tmp_path: Path) -> None:
    with pytest.raises(LessonLostError, match=r"lesson-1-after-0-1: .*'fly'; .*\bfly\b"):
        teach(tmp_path / "knowledge", FLYING)
    with pytest.raises(LessonLostError, match=r"exam-1: .*'fly'"):
        examined(FLYING)
