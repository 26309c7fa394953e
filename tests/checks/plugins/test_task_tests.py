"""The inherited tests of a task: the shipped ones and one of another author pass; a broken promise fails its test."""

from collections.abc import Callable
from contextlib import closing
from typing import Any

import pytest

from config.settings import SettingsError
from hal.robot_settings import load_robot
from kurt2rt.checks.plugins.task_tests import TaskTests
from simbridge.contracts.robot_kind import simulations_of

TASKS = ("circle", "eight", "fleeing", "wall_following", "streets", "route", "errands")
TASKS_OF_ROBOTS = ("school/circle", "school/fleeing", "school/wall_following", "turtlebot/fleeing")


class TestShippedTasks(TaskTests):
    @pytest.fixture(autouse=True, params=(*TASKS, *TASKS_OF_ROBOTS))
    def named(self, request: pytest.FixtureRequest) -> None:
        self.task = request.param


class Part:
    """Part that breaks the promises of each kind."""

    unit, behaviour = "", ""
    behaviours = ("",)

    def __init__(self) -> None:
        self.asked = 0
        self.progress = 1.0

    def build(self, *_: object) -> "Part":
        return Part()

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it looks at nothing
        self.asked += 1
        return "forward" if self.asked % 3 else "fly"

    def judge(self, features: object) -> int:  # noqa: ARG002 - as above
        self.asked += 1
        return self.asked % 4

    def start(self) -> None:
        pass

    def step(self, readings: object) -> tuple[float, float]:  # noqa: ARG002 - as above
        self.asked += 1
        return self.asked, 0.0

    def reset(self, pose: object) -> None:  # noqa: ARG002 - as above
        self.progress += 1.0

    def update(self, pose: object) -> None:
        pass

    @property
    def findings(self) -> dict[str, float]:
        return {"odd": float("nan")}


class Broken(TaskTests):
    task = "wall_following"

    def loaded(self) -> Any:
        task, robot = super().loaded()
        part = Part()
        return task.model_copy(update={"policy": part, "judge": part, "metric": part}), robot

    def _actions(self) -> list[Any]:
        return [Part()]


@pytest.mark.parametrize(
    "promise",
    [
        Broken.test_policy_names_actions_of_the_repertoire,
        Broken.test_policy_has_no_memory,
        Broken.test_judge_returns_minus_one_zero_or_one,
        Broken.test_judge_has_no_memory,
        Broken.test_actions_return_speeds_that_the_guard_takes,
        Broken.test_start_resets_each_action,
    ],
)
def test_broken_part_fails_the_test_about_it(promise: Callable[[Broken], None]) -> None:
    with pytest.raises(AssertionError):
        promise(Broken())


@pytest.mark.parametrize(
    "promise",
    [
        Broken.test_metric_begins_without_progress_in_a_unit_and_a_behaviour,
        Broken.test_metric_of_the_same_poses_is_the_same_and_finite,
    ],
)
def test_broken_metric_fails_the_test_about_it(promise: Callable[[Broken, object], None]) -> None:
    opened = closing(simulations_of(load_robot()).open("a", 1, "test"))
    with opened as simulation, pytest.raises(AssertionError):
        promise(Broken(), simulation)


def test_task_of_another_robot_is_refused() -> None:
    tests = TaskTests()
    tests.task, tests.robot = "school/fleeing", "kurt2"
    with pytest.raises(SettingsError, match="is for the robot school"):
        tests.test_policy_has_no_memory()
