"""Tests that every policy, judge, metric, action, world and task passes, on made-up readings and poses."""

import json
import math
import random
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from typing import TypeVar

import pytest

from behaviors.behaviour import Behaviour
from behaviors.judges.judge import AppraisalFeatures, JudgeSettings
from behaviors.metrics.task_metric import MetricSettings, TaskMetric
from behaviors.policies.policy import PolicySettings
from behaviors.repertoire import primitive_speeds
from behaviors.repertoire_settings import PluginAction
from config.settings import Settings
from hal.robot import HIGHEST_COUNTS, SensorReadings, WheelSpeeds
from hal.robot_settings import RobotSettings
from kurt2rt.core.critic.appraisal_features import AppraisalPerception
from kurt2rt.core.critic.sides import critic_of
from kurt2rt.core.task_robot import load_task_and_robot
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.compatibility import require_metric
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from simbridge.contracts.robot_kind import simulations_of
from simbridge.contracts.simulation import Pose, Simulation

_SEED, _PURPOSE, _TRIED = 1, "plug-in test", 200
_STEP_M = 0.01

_InputT = TypeVar("_InputT")


class _PartTests:
    """A task and a robot to try a part with."""

    task: str = "wall_following"
    """Name or path of the task whose repertoire, behaviours and first world the part is tried with."""
    robot: str | None = None
    """Name or path of the robot that it is tried on; None: that of the task."""

    def loaded(self) -> tuple[TaskSettings, RobotSettings]:
        """Return the task and the robot. Raises config.settings.SettingsError, also if the robot lacks a sensor."""
        return load_task_and_robot(self.task, self.robot)


class PolicyTests(_PartTests, ABC):
    """Tests of a policy. Inherit them, and name its settings.

    For example:

        class TestFlight(PolicyTests):
            policy = Flight(kind="my_policy:Flight")
    """

    @property
    @abstractmethod
    def policy(self) -> PolicySettings:
        """Settings of the policy under test; the plug-in's test gives them."""

    def test_policy_is_the_same_once_it_was_written_as_json(self) -> None:
        assert _through_json(self.policy) == self.policy

    def test_policy_names_actions_of_the_repertoire(self) -> None:
        assert set(self._chosen(self._asked())) <= set(load_task_repertoire(*self.loaded()))

    def test_policy_has_no_memory(self) -> None:
        _require_no_memory(self._chosen, self._asked())

    def _chosen(self, asked: Sequence[tuple[tuple[int, ...], str]]) -> list[str]:
        policy = self.policy.build(self.loaded()[1].infrared)
        return [policy.choose(view, behaviour) for view, behaviour in asked]

    def _asked(self) -> list[tuple[tuple[int, ...], str]]:
        behaviours = self.policy.behaviours or ("",)
        return [(view, behaviour) for view in _views(self.loaded()[1]) for behaviour in behaviours]


class JudgeTests(_PartTests, ABC):
    """Tests of a judge. Inherit them, and name its settings.

    For example:

        class TestHarsh(JudgeTests):
            judge = Harsh(kind="my_judge:Harsh")
    """

    @property
    @abstractmethod
    def judge(self) -> JudgeSettings | None:
        """Settings of the judge; None for a task without rewards."""

    def test_judge_is_the_same_once_it_was_written_as_json(self) -> None:
        assert _through_json(self._settings()) == self.judge

    def test_judge_returns_minus_one_zero_or_one(self) -> None:
        assert set(self._rewards(_made_up_features())) <= {-1, 0, 1}

    def test_judge_has_no_memory(self) -> None:
        _require_no_memory(self._rewards, _made_up_features())

    def _rewards(self, asked: Sequence[AppraisalFeatures]) -> list[int]:
        judge = self._settings().build()
        return [judge.judge(each) for each in asked]

    def _settings(self) -> JudgeSettings:
        return self.judge or pytest.skip("the task has no judge")


class MetricTests(_PartTests, ABC):
    """Tests of a metric. Inherit them, and name its settings.

    For example:

        class TestReach(MetricTests):
            metric = Reach(kind="my_metric:Reach")
    """

    @property
    @abstractmethod
    def metric(self) -> MetricSettings:
        """Settings of the metric under test; the plug-in's test gives them."""

    @pytest.fixture
    def simulation(self) -> Iterator[Simulation]:
        """Return a simulated robot in the first world of the task."""
        task, robot = self.loaded()
        with closing(simulations_of(robot).open(task.teaching.world, _SEED, _PURPOSE)) as simulation:
            yield simulation

    def test_metric_is_the_same_once_it_was_written_as_json(self) -> None:
        assert _through_json(self.metric) == self.metric

    def test_metric_takes_the_world(self, simulation: Simulation) -> None:
        self.metric.require(simulation.plan, self.loaded()[0].behaviours)

    def test_metric_begins_without_progress_in_a_unit_and_a_behaviour(self, simulation: Simulation) -> None:
        metric = self._new_metric(simulation)
        assert metric.progress == 0
        assert isinstance(metric.unit, str)
        assert metric.unit
        assert metric.behaviour in self.loaded()[0].behaviours

    def test_progress_and_findings_are_finite(self, simulation: Simulation) -> None:
        metric = self._driven(simulation)
        assert all(math.isfinite(each) for each in (metric.progress, *metric.findings.values()))

    def test_the_same_poses_give_the_same_progress(self, simulation: Simulation) -> None:
        assert self._driven(simulation).progress == self._driven(simulation).progress

    def test_reset_adds_no_progress(self, simulation: Simulation) -> None:
        metric = self._driven(simulation)
        before = metric.progress
        metric.reset(_walk(simulation.pose)[0])
        assert metric.progress == before

    def test_abort_ends_a_drive_at_any_time(self, simulation: Simulation) -> None:
        metric = self._driven(simulation)
        metric.abort()
        assert math.isfinite(metric.progress)

    def _new_metric(self, simulation: Simulation) -> TaskMetric:
        metric = self.metric.build(simulation, self.loaded()[0].behaviours, random.Random(_SEED))
        metric.reset(_walk(simulation.pose)[0])
        return metric

    def _driven(self, simulation: Simulation) -> TaskMetric:
        metric = self._new_metric(simulation)
        for pose in _walk(simulation.pose):
            metric.update(pose)
        return metric


class ActionTests(_PartTests, ABC):
    """Tests of an action. Inherit them, and name its settings.

    For example:

        class TestWiggling(ActionTests):
            action = Wiggling(kind="my_action:Wiggling", name="wiggle")
    """

    @property
    @abstractmethod
    def action(self) -> PluginAction:
        """Entry of the action under test; the plug-in's test gives it."""

    def test_action_is_the_same_once_it_was_written_as_json(self) -> None:
        assert _through_json(self.action) == self.action

    def test_step_returns_two_speeds_that_the_guard_takes(self) -> None:
        fastest_m_s = self.loaded()[1].guard.maximum_speed_m_s
        assert all(abs(speed) <= fastest_m_s for both in self._speeds(self._new_action()) for speed in both)

    def test_start_resets_the_action(self) -> None:
        action = self._new_action()
        assert self._speeds(action) == self._speeds(action) == self._speeds(self._new_action())

    def test_finished_and_lost_are_true_or_false(self) -> None:
        action = self._new_action()
        self._speeds(action)
        assert {type(each) for each in (action.finished, action.lost)} == {bool}

    def _new_action(self) -> Behaviour:
        return self.action.build(self.loaded()[1])

    def _speeds(self, action: Behaviour) -> list[tuple[float, float]]:
        action.start()
        views = enumerate(_views(self.loaded()[1]))
        return [(left_m_s, right_m_s) for left_m_s, right_m_s in (action.step(_readings(*view)) for view in views)]


class WorldTests(_PartTests):
    """Tests of a world. Inherit them, and name it: `world = "my_hall.yaml"`, or `my_hall:world` of a function."""

    world: str

    def test_world_is_the_same_each_time(self) -> None:
        worlds = simulations_of(self.loaded()[1])
        worlds.require_worlds(self.world)
        assert worlds.settings_of(self.world) == worlds.settings_of(self.world)


class TaskTests(PolicyTests, JudgeTests, MetricTests):
    """Tests of a task with its policy, judge and metric. Inherit them, and name it: `task = "my_task.yaml"`."""

    @property
    def policy(self) -> PolicySettings:
        """Settings of the task's policy."""
        return self.loaded()[0].policy

    @property
    def judge(self) -> JudgeSettings | None:
        """Settings of the task's judge."""
        return self.loaded()[0].judge

    @property
    def metric(self) -> MetricSettings:
        """Settings of the task's metric."""
        return self.loaded()[0].metric

    def test_worlds_have_what_the_course_needs(self) -> None:
        task, robot = self.loaded()
        worlds = (task.teaching.world, *task.exam.worlds)
        simulations_of(robot).require_worlds(*worlds)
        require_metric(simulations_of(robot), task, worlds)

    def test_critic_has_its_sensors(self) -> None:
        task, robot = self.loaded()
        AppraisalPerception(critic_of(task.critic, robot), robot)

    def test_judge_does_not_punish_what_the_policy_does_in_the_open(self) -> None:
        """Thresholds of a robot that sees farther call each place narrow."""
        task, robot = self.loaded()
        infrared, speeds = robot.infrared, primitive_speeds(task.repertoire)
        nothing_in_view = (infrared.floor_counts,) * len(infrared.names)
        policy = self.policy.build(infrared)
        chosen = {policy.choose(nothing_in_view, behaviour) for behaviour in self.policy.behaviours or ("",)}
        assert -1 not in self._rewards([_in_the_open(speeds[each], robot) for each in chosen if each in speeds])


def _through_json(settings: Settings) -> Settings:
    """Return settings as they are read after they were written as JSON."""
    return type(settings).model_validate_json(json.dumps(settings.model_dump(mode="json")))


def _require_no_memory(answers: Callable[[Sequence[_InputT]], Sequence[object]], asked: Sequence[_InputT]) -> None:
    """Assert that the answers to the same questions are equal in another order."""
    order = list(range(len(asked)))
    random.Random(_SEED).shuffle(order)
    first, second = answers(asked), answers([asked[place] for place in order])
    assert [first[place] for place in order] == list(second)


def _made_up_features() -> list[AppraisalFeatures]:
    chance, names = random.Random(_SEED), AppraisalFeatures._fields
    features = [AppraisalFeatures(*(chance.uniform(-1.0, 1.0) for _ in names)) for _ in range(_TRIED)]
    clear = {"left_m": 0.6, "front_m": 0.6, "right_m": 0.6, "bumped": 0.0, "no_progress": 0.0}
    return features + [each._replace(**clear) for each in features]


def _in_the_open(speeds: WheelSpeeds, robot: RobotSettings) -> AppraisalFeatures:
    """Return the features of a drive at these wheel speeds where nothing is in view."""
    far_m, names = robot.infrared.far_m, AppraisalFeatures._fields
    view = AppraisalFeatures(*(far_m if each.endswith("_m") else 0.0 for each in names))
    left_m_s, right_m_s = speeds
    turn_rad_s = (right_m_s - left_m_s) / robot.geometry.effective_track_m
    return view._replace(speed_m_s=(left_m_s + right_m_s) / 2, turn_rad_s=turn_rad_s, no_wall=1.0)


def _views(robot: RobotSettings) -> list[tuple[int, ...]]:
    """Return readings of all sensors in counts: random ones, and the same from all sensors."""
    chance, sensors = random.Random(_SEED), len(robot.infrared.names)
    made = [tuple(chance.randint(0, HIGHEST_COUNTS) for _ in range(sensors)) for _ in range(_TRIED)]
    return [*made, *((counts,) * sensors for counts in (0, 70, 300, HIGHEST_COUNTS))]


def _readings(number: int, view: tuple[int, ...]) -> SensorReadings:
    return SensorReadings(
        time_s=number * 0.01,
        infrared_counts=view,
        infrared_age_s=0.0,
        encoder_left_ticks=number % 7,
        encoder_right_ticks=number % 5,
        encoder_age_s=0.0,
        bumpers=0,
        bumper_age_s=0.0,
    )


def _walk(start: Pose) -> list[Pose]:
    """Return poses of a drive along a bend, one for each tick."""
    poses, pose = [], start
    for _ in range(_TRIED):
        poses.append(pose)
        x_m, y_m = pose.x_m + _STEP_M * math.cos(pose.heading_rad), pose.y_m + _STEP_M * math.sin(pose.heading_rad)
        pose = Pose(x_m, y_m, pose.heading_rad + 0.01)
    return poses
