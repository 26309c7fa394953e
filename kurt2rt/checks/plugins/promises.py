"""Promises of the parts of a task, tried on made-up readings and poses."""

import json
import math
import random
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import TypeVar

from behaviors.behaviour import Behaviour
from behaviors.judges.judge import AppraisalFeatures, JudgeSettings
from behaviors.metrics.task_metric import MetricSettings, TaskMetric
from behaviors.policies.policy import PolicySettings
from behaviors.repertoire_settings import PluginAction
from hal.robot import HIGHEST_COUNTS, SensorReadings, WheelSpeeds
from hal.robot_settings import RobotSettings
from hal.settings import Settings
from hal.simulation import Pose, Simulation
from kurt2rt.core.learner.conformance import broken_among

_SEED, _TRIED = 1, 200
_STEP_M = 0.01

_InputT = TypeVar("_InputT")


def broken_of_policy(
    settings: PolicySettings, robot: RobotSettings, actions: Collection[str], behaviours: Sequence[str]
) -> list[str]:
    """Return the promises that a policy breaks, each in a sentence.

    `actions`: of the repertoire. `behaviours`: taught behaviours of the task.
    """
    views = [(view, behaviour) for view in _views(len(robot.infrared.names)) for behaviour in behaviours]

    def chosen(asked: Sequence[tuple[tuple[int, ...], str]]) -> list[str]:
        policy = settings.build(robot.infrared)
        return [policy.choose(view, behaviour) for view, behaviour in asked]

    return broken_among(
        (
            ("its settings are the same once they were written as JSON", lambda: _survives_json(settings)),
            ("`choose` names an action of the repertoire", lambda: _all_known(chosen(views), actions)),
            ("`choose` has no memory", lambda: _has_no_memory(chosen, views)),
        )
    )


def broken_of_judge(settings: JudgeSettings) -> list[str]:
    """Return the promises that a judge breaks, each in a sentence."""
    chance = random.Random(_SEED)
    fields = AppraisalFeatures._fields
    features = [AppraisalFeatures(*(chance.uniform(-1.0, 1.0) for _ in fields)) for _ in range(_TRIED)]
    features += [each._replace(left_m=0.6, front_m=0.6, right_m=0.6, bumped=0.0, no_progress=0.0) for each in features]

    def rewards(asked: Sequence[AppraisalFeatures]) -> list[int]:
        judge = settings.build()
        return [judge.judge(each) for each in asked]

    return broken_among(
        (
            ("its settings are the same once they were written as JSON", lambda: _survives_json(settings)),
            ("`judge` returns -1, 0 or 1", lambda: set(rewards(features)) <= {-1, 0, 1}),
            ("`judge` has no memory", lambda: _has_no_memory(rewards, features)),
        )
    )


def broken_of_judge_on_robot(
    judge: JudgeSettings, policy: PolicySettings, robot: RobotSettings, speeds: Mapping[str, WheelSpeeds]
) -> list[str]:
    """Return the promises that a judge breaks on a robot, each in a sentence.

    Thresholds of a robot that sees farther call each place narrow.

    Args:
        judge: of the task.
        policy: of the task.
        robot: that is judged.
        speeds: wheel speeds of the motor primitives by name.
    """
    infrared = robot.infrared

    def accepts_the_open() -> bool:
        names = {
            policy.build(infrared).choose((infrared.floor_counts,) * len(infrared.names), behaviour)
            for behaviour in policy.behaviours or ("",)
        }
        rewards = [judge.build().judge(_in_the_open(speeds[name], robot)) for name in names if name in speeds]
        return -1 not in rewards

    return broken_among((("`judge` does not punish what the policy does where nothing is in view", accepts_the_open),))


def broken_of_metric(settings: MetricSettings, simulation: Simulation, behaviours: tuple[str, ...]) -> list[str]:
    """Return the promises that a metric breaks, each in a sentence.

    `simulation`: world to try it in. `behaviours`: taught behaviours of the task.
    """
    poses = _walk(simulation.pose)

    def new() -> TaskMetric:
        metric = settings.build(simulation, behaviours, random.Random(_SEED))
        metric.reset(poses[0])
        return metric

    def driven() -> TaskMetric:
        metric = new()
        for pose in poses:
            metric.update(pose)
        return metric

    def resets_without_progress() -> bool:
        metric = driven()
        before = metric.progress
        metric.reset(poses[0])
        return metric.progress == before

    def aborts() -> bool:
        metric = driven()
        metric.abort()
        return math.isfinite(metric.progress)

    def requires_nothing_else() -> bool:
        settings.require(simulation.plan, behaviours)
        return True

    return broken_among(
        (
            ("its settings are the same once they were written as JSON", lambda: _survives_json(settings)),
            ("`require` takes the world", requires_nothing_else),
            ("`unit` is a text", lambda: _is_text(new().unit)),
            ("`behaviour` is one of the task's", lambda: new().behaviour in behaviours),
            ("`progress` begins at 0", lambda: new().progress == 0),
            ("`progress` and `findings` are finite numbers", lambda: _are_finite(driven())),
            ("the same poses give the same progress", lambda: driven().progress == driven().progress),
            ("`reset` adds no progress", resets_without_progress),
            ("`abort` ends a drive at any time", aborts),
        )
    )


def broken_of_action(settings: PluginAction, robot: RobotSettings) -> list[str]:
    """Return the promises that an action breaks, each in a sentence."""
    readings = [_readings(view, number) for number, view in enumerate(_views(len(robot.infrared.names)))]
    most_m_s = robot.guard.maximum_speed_m_s

    def new() -> Behaviour:
        return settings.build(robot)

    def speeds(action: Behaviour) -> list[tuple[float, float]]:
        action.start()
        return [(left_m_s, right_m_s) for left_m_s, right_m_s in map(action.step, readings)]

    def starts_anew() -> bool:
        action = new()
        return speeds(action) == speeds(action) == speeds(new())

    def ends_in_words() -> bool:
        action = new()
        speeds(action)
        return {type(each) for each in (action.finished, action.lost)} == {bool}

    return broken_among(
        (
            ("its settings are the same once they were written as JSON", lambda: _survives_json(settings)),
            (
                f"`step` returns two speeds of at most {most_m_s} m/s",
                lambda: all(abs(speed) <= most_m_s for both in speeds(new()) for speed in both),
            ),
            ("`start` resets its state", starts_anew),
            ("`finished` and `lost` are True or False", ends_in_words),
        )
    )


def _all_known(chosen: Sequence[str], actions: Collection[str]) -> bool | str:
    unknown = ", ".join(sorted(set(chosen) - set(actions)))
    return not unknown or f"it names {unknown}, and the repertoire has {', '.join(actions)}"


def _survives_json(settings: Settings) -> bool:
    return type(settings).model_validate_json(json.dumps(settings.model_dump(mode="json"))) == settings


def _has_no_memory(answers: Callable[[Sequence[_InputT]], Sequence[object]], asked: Sequence[_InputT]) -> bool:
    """Return whether the answers to the same questions are equal in another order."""
    order = list(range(len(asked)))
    random.Random(_SEED).shuffle(order)
    first, second = answers(asked), answers([asked[place] for place in order])
    return [first[place] for place in order] == list(second)


def _in_the_open(speeds: WheelSpeeds, robot: RobotSettings) -> AppraisalFeatures:
    """Return the features of a drive at these wheel speeds where nothing is in view."""
    far_m, names = robot.infrared.far_m, AppraisalFeatures._fields
    view = AppraisalFeatures(*(far_m if each.endswith("_m") else 0.0 for each in names))
    left_m_s, right_m_s = speeds
    turn_rad_s = (right_m_s - left_m_s) / robot.geometry.effective_track_m
    return view._replace(speed_m_s=(left_m_s + right_m_s) / 2, turn_rad_s=turn_rad_s, no_wall=1.0)


def _views(sensors: int) -> list[tuple[int, ...]]:
    """Return readings of all sensors in counts: random ones, and the same from all sensors."""
    chance = random.Random(_SEED)
    made = [tuple(chance.randint(0, HIGHEST_COUNTS) for _ in range(sensors)) for _ in range(_TRIED)]
    return [*made, *((counts,) * sensors for counts in (0, 70, 300, HIGHEST_COUNTS))]


def _readings(view: tuple[int, ...], number: int) -> SensorReadings:
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


def _is_text(given: object) -> bool:
    return isinstance(given, str) and bool(given)


def _are_finite(metric: TaskMetric) -> bool:
    return all(math.isfinite(each) for each in (metric.progress, *metric.findings.values()))
