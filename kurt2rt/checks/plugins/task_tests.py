"""Tests that every task passes, with its policy, judge, metric, actions and worlds, on made-up readings and poses."""

import json
import math
import random
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from typing import TypeVar

import pytest

from behaviors.behaviour import Behaviour
from behaviors.judges.judge import AppraisalFeatures
from behaviors.metrics.task_metric import TaskMetric
from behaviors.repertoire import primitive_speeds
from config.settings import Settings
from hal.robot import HIGHEST_COUNTS, SensorReadings, WheelSpeeds
from hal.robot_settings import RobotSettings
from kurt2rt.core.critic.appraisal_features import AppraisalPerception
from kurt2rt.core.critic.settings import critic_of
from kurt2rt.core.task_robot import load_task_and_robot
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.compatibility import require_metric
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from simbridge.contracts.robot_kind import simulations_of
from simbridge.contracts.simulation import Pose, Simulation

_SEED, _PURPOSE, _TRIED = 1, "plug-in test", 200
_STEP_M = 0.01

_InputT = TypeVar("_InputT")


class TaskTests:
    """Tests of a task and of all that it names. Inherit them, and name it.

    For example:

        class TestWandering(TaskTests):
            task = "my_task.yaml"
    """

    task: str
    """Name or path of the task."""
    robot: str | None = None
    """Name or path of the robot that it is tried on; None: that of the task."""

    def loaded(self) -> tuple[TaskSettings, RobotSettings]:
        """Return the task and the robot. Raises config.settings.SettingsError, also if the robot lacks a sensor."""
        return load_task_and_robot(self.task, self.robot)

    def test_parts_are_the_same_once_they_were_written_as_json(self) -> None:
        task, _ = self.loaded()
        parts = [each for each in (task.policy, task.judge, task.metric) if each is not None]
        assert [_through_json(each) for each in parts] == parts

    def test_policy_names_actions_of_the_repertoire(self) -> None:
        assert set(self._chosen(self._asked())) <= set(load_task_repertoire(*self.loaded()))

    def test_policy_has_no_memory(self) -> None:
        _require_no_memory(self._chosen, self._asked())

    def test_judge_returns_minus_one_zero_or_one(self) -> None:
        assert set(self._rewards(_made_up_features())) <= {-1, 0, 1}

    def test_judge_has_no_memory(self) -> None:
        _require_no_memory(self._rewards, _made_up_features())

    def test_judge_does_not_punish_what_the_policy_does_in_the_open(self) -> None:
        """Thresholds of a robot that sees farther call each place narrow."""
        task, robot = self.loaded()
        infrared, speeds = robot.infrared, primitive_speeds(task.repertoire)
        nothing_in_view = (infrared.floor_counts,) * len(infrared.names)
        policy = task.policy.build(infrared)
        chosen = {policy.choose(nothing_in_view, behaviour) for behaviour in task.policy.behaviours or ("",)}
        assert -1 not in self._rewards([_in_the_open(speeds[each], robot) for each in chosen if each in speeds])

    @pytest.fixture
    def simulation(self) -> Iterator[Simulation]:
        """Return a simulated robot in the first world of the task."""
        task, robot = self.loaded()
        with closing(simulations_of(robot).open(task.teaching.world, _SEED, _PURPOSE)) as simulation:
            yield simulation

    def test_metric_begins_without_progress_in_a_unit_and_a_behaviour(self, simulation: Simulation) -> None:
        metric = self._new_metric(simulation)
        assert metric.progress == 0
        assert metric.unit
        assert metric.behaviour in self.loaded()[0].behaviours

    def test_metric_of_the_same_poses_is_the_same_and_finite(self, simulation: Simulation) -> None:
        metric = self._driven(simulation)
        assert metric.progress == self._driven(simulation).progress
        assert all(math.isfinite(each) for each in (metric.progress, *metric.findings.values()))
        before = metric.progress
        metric.reset(_walk(simulation.pose)[0])
        assert metric.progress == before, "being put elsewhere is no progress"

    def test_actions_return_speeds_that_the_guard_takes(self) -> None:
        fastest_m_s = self.loaded()[1].guard.maximum_speed_m_s
        speeds = [each for action in self._actions() for both in self._speeds(action) for each in both]
        assert max(map(abs, speeds)) <= fastest_m_s

    def test_start_resets_each_action(self) -> None:
        for action in self._actions():
            assert self._speeds(action) == self._speeds(action)

    def test_worlds_have_what_the_course_needs_each_time(self) -> None:
        task, robot = self.loaded()
        worlds, factory = (task.teaching.world, *task.exam.worlds), simulations_of(robot)
        factory.require_worlds(*worlds)
        require_metric(factory, task, worlds)
        assert [factory.settings_of(each) for each in worlds] == [factory.settings_of(each) for each in worlds]

    def test_critic_has_its_sensors(self) -> None:
        task, robot = self.loaded()
        AppraisalPerception(critic_of(task.critic, robot), robot)

    def _chosen(self, asked: Sequence[tuple[tuple[int, ...], str]]) -> list[str]:
        task, robot = self.loaded()
        policy = task.policy.build(robot.infrared)
        return [policy.choose(view, behaviour) for view, behaviour in asked]

    def _asked(self) -> list[tuple[tuple[int, ...], str]]:
        task, robot = self.loaded()
        return [(view, behaviour) for view in _views(robot) for behaviour in task.policy.behaviours or ("",)]

    def _rewards(self, asked: Sequence[AppraisalFeatures]) -> list[int]:
        settings = self.loaded()[0].judge
        if settings is None:
            pytest.skip("the task has no judge")
        judge = settings.build()
        return [judge.judge(each) for each in asked]

    def _new_metric(self, simulation: Simulation) -> TaskMetric:
        task, _ = self.loaded()
        metric = task.metric.build(simulation, task.behaviours, random.Random(_SEED))
        metric.reset(_walk(simulation.pose)[0])
        return metric

    def _driven(self, simulation: Simulation) -> TaskMetric:
        metric = self._new_metric(simulation)
        for pose in _walk(simulation.pose):
            metric.update(pose)
        return metric

    def _actions(self) -> list[Behaviour]:
        return list(load_task_repertoire(*self.loaded()).values())

    def _speeds(self, action: Behaviour) -> list[tuple[float, float]]:
        action.start()
        views = enumerate(_views(self.loaded()[1]))
        return [(left_m_s, right_m_s) for left_m_s, right_m_s in (action.step(_readings(*view)) for view in views)]


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
