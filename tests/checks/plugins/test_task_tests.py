"""The inherited tests of the parts of a task: the shipped tasks pass, and parts that break a promise fail."""

from collections.abc import Callable
from contextlib import closing
from typing import Any

import pytest

from behaviors.judges.judge import JudgeSettings
from behaviors.policies.policy import PolicySettings
from config.settings import SettingsError
from hal.robot_settings import load_robot
from kurt2rt.checks.plugins.task_tests import ActionTests, JudgeTests, MetricTests, PolicyTests, TaskTests, WorldTests
from simbridge.contracts.robot_kind import simulations_of
from tests.plugin_parts import Moving, Reach, Turning, Wiggling

TASKS = ("circle", "eight", "fleeing", "wall_following", "streets", "route", "errands")
TASKS_OF_ROBOTS = ("school/circle", "school/fleeing", "school/wall_following", "turtlebot/fleeing")


class TestShippedTasks(TaskTests):
    @pytest.fixture(autouse=True, params=(*TASKS, *TASKS_OF_ROBOTS))
    def named(self, request: pytest.FixtureRequest) -> None:
        self.task = request.param


class TestPartsOfAnotherAuthor(PolicyTests, JudgeTests, MetricTests, ActionTests):
    policy = Turning(kind="parts:Turning")
    judge = Moving(kind="parts:Moving")
    metric = Reach(kind="parts:Reach")
    action = Wiggling(kind="parts:Wiggling", name="wiggle")


class TestTurningOfTheSchoolRobot(PolicyTests):
    task = "school/fleeing"

    @property
    def policy(self) -> PolicySettings:
        return self.loaded()[0].policy


class TestWorld(WorldTests):
    world = "a"


class Part:
    """Part that breaks the promises of each kind."""

    unit, needs_reset, behaviour, finished, lost = "m", False, "", False, 0

    def __init__(self) -> None:
        self.asked = 0
        self.progress = 1.0

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

    def abort(self) -> None:
        self.progress = float("inf")

    @property
    def findings(self) -> dict[str, float]:
        return {"odd": float("nan")}


class BrokenPolicy(PolicySettings):
    def build(self, *_: object, **__: object) -> Any:
        return Part()


class BrokenJudge(JudgeSettings):
    def build(self, *_: object, **__: object) -> Any:
        return Part()


class BrokenMetric(Reach):
    def build(self, *_: object, **__: object) -> Any:
        return Part()


class BrokenAction(Wiggling):
    def build(self, *_: object, **__: object) -> Any:
        return Part()


class Broken(PolicyTests, JudgeTests, MetricTests, ActionTests):
    policy = BrokenPolicy(kind="broken")
    judge = BrokenJudge(kind="broken")
    metric = BrokenMetric(kind="broken")
    action = BrokenAction(kind="broken", name="leap")


@pytest.mark.parametrize(
    "promise",
    [
        Broken.test_policy_names_actions_of_the_repertoire,
        Broken.test_policy_has_no_memory,
        Broken.test_judge_returns_minus_one_zero_or_one,
        Broken.test_judge_has_no_memory,
        Broken.test_step_returns_two_speeds_that_the_guard_takes,
        Broken.test_start_resets_the_action,
        Broken.test_finished_and_lost_are_true_or_false,
    ],
)
def test_broken_part_fails_the_test_about_it(promise: Callable[[Broken], None]) -> None:
    with pytest.raises(AssertionError):
        promise(Broken())


@pytest.mark.parametrize(
    "promise",
    [
        Broken.test_metric_begins_without_progress_in_a_unit_and_a_behaviour,
        Broken.test_progress_and_findings_are_finite,
        Broken.test_reset_adds_no_progress,
        Broken.test_abort_ends_a_drive_at_any_time,
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


@pytest.mark.parametrize("tests", [PolicyTests, JudgeTests, MetricTests, ActionTests])
def test_tests_without_a_part_say_what_is_missing(tests: Callable[[], object]) -> None:
    with pytest.raises(TypeError, match=r"abstract \w+ '?(policy|judge|metric|action)"):
        tests()
