"""Minds and settings of a batch, from a task and its knowledge, and the refusal of what a batch does not know."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from behaviors.behaviour import Behaviour
from behaviors.keep_distance import KeepDistance
from behaviors.motor_primitive import MotorPrimitive
from behaviors.turn_by_angle import TurnByAngle
from hal.kurt2_settings import Kurt2Settings
from hal.robot_settings import RobotSettings
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.perception.definition import SituationDefinition, feature_weights, load_situation
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.episode import build_stuck_rule
from kurt2rt.experiments.lockstep.exam import ExamSetup, build_exam_runtime
from kurt2rt.experiments.lockstep.lesson_plan import plan_of
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.runtime import Runtime, RuntimeOptions
from simbridge.contracts.batch import (
    MOST_KEPT,
    Action,
    BatchRefusedError,
    CallbackMind,
    Choose,
    DriveSettings,
    FeatureTable,
    FixedSpeeds,
    FollowedSimulation,
    Mind,
    PolicyMind,
    StuckRule,
    TabledPolicy,
    TaughtMind,
    Turn,
    WallDistance,
)
from simbridge.contracts.batch_lesson import LessonDriveSettings

_BORDER_METRICS = ("junctions",)
"""Courses that reposition the robot, or want another behaviour, at borders."""
_METRICS = ("laps", "way", "rounds", "eights", *_BORDER_METRICS)
"""Courses that never reposition the robot nor want another behaviour, or at borders only."""
_ON_THE_BUS = "use the CAN bus (--engine can)"


def require_known_robot(settings: RobotSettings, task: TaskSettings) -> None:
    """Check that a batch knows a kind of robot. Raises BatchRefusedError."""
    if not isinstance(settings, Kurt2Settings):
        raise refused(task, f"a robot of kind {settings.kind}")


def require_known_task(task: TaskSettings, *, by_policy: bool = False) -> None:
    """Check that a batch knows metric and levels of a task. Raises BatchRefusedError.

    `by_policy`: whether the policy drives, without the levels.
    """
    if task.metric.kind not in _METRICS:
        raise refused(task, f"metric {task.metric.kind} (a batch knows {', '.join(_METRICS)})")
    if task.mid is not None and not by_policy:
        raise refused(task, "a mid level")


def stuck_rule_of(settings: RobotSettings, task: TaskSettings) -> StuckRule:
    """Return the rule by which a robot is stuck in an exam."""
    return build_stuck_rule(task.exam.stuck_after_s, settings.cycle_s, least_m=task.exam.stuck_within_m)


def require_known(settings: RobotSettings, task: TaskSettings, setups: Sequence[ExamSetup]) -> None:
    """Check that a batch can drive exams of a task. Raises BatchRefusedError."""
    doubt = task.learning.doubt
    require_known_robot(settings, task)
    if stuck_rule_of(settings, task).positions > MOST_KEPT:
        raise refused(task, f"robots that are stuck after {task.exam.stuck_after_s:g} s")
    require_known_task(task, by_policy=all(setup.teacher_policy for setup in setups))
    if doubt is not None and doubt.asks and doubt.alone:
        raise refused(task, "a robot that stands at a doubt without a teacher")
    if any(setup.broken for setup in setups):
        raise refused(task, "a broken sensor")


def require_known_exams(settings: RobotSettings, task: TaskSettings, *, policy: bool = True) -> None:
    """Check that a batch can examine robots that are taught a task, and drive its policy unless `policy` is False.

    Raises BatchRefusedError, and config.settings.SettingsError if settings of the task do not fit each other.
    """
    require_known(settings, task, [ExamSetup(task.teaching.world, 0)])
    if policy and not isinstance(task.policy.build(settings.infrared), TabledPolicy):
        raise refused(task, f"policy {task.policy.kind}")
    _known_parts(settings, task)


def require_known_lesson(settings: RobotSettings, task: TaskSettings) -> None:
    """Check that a batch can teach a task with its teacher. Raises BatchRefusedError."""
    build_lesson_settings(settings, task)


def build_lesson_settings(
    settings: RobotSettings, task: TaskSettings, choose: Choose | None = None
) -> LessonDriveSettings:
    """Return what a batch needs to know of a robot that is taught a task by its teacher.

    `choose`: choice of its actions, for situations in counts; None: RLAs decide, for weighted situations.

    Raises:
        BatchRefusedError: the batch does not know the task or its teacher.
        config.settings.SettingsError: settings of the task do not fit each other.
    """
    require_known_robot(settings, task)
    require_known_task(task)
    doubt = task.learning.doubt
    if doubt is not None and doubt.asks:
        raise refused(task, "a robot that asks at a doubt")
    policy = task.policy.build(settings.infrared)
    if not isinstance(policy, TabledPolicy):
        raise refused(task, f"policy {task.policy.kind}")
    drive, features = _known_parts(settings, task, weighted=choose is None)
    return LessonDriveSettings(
        actions=dict(drive.actions),
        minimum_ticks=drive.minimum_ticks,
        behaviours=task.behaviours,
        policy=policy,
        features=features,
        ticks=round(plan_of(task).duration_s / settings.cycle_s),
        choose=choose,
    )


def _known_parts(
    settings: RobotSettings, task: TaskSettings, *, weighted: bool = True
) -> tuple[DriveSettings, FeatureTable]:
    """Return the actions and the features of a task, which a batch knows all.

    `weighted`: whether the features have the weights of the task, not 1. Raises BatchRefusedError.
    """
    definition = load_situation(task.situation, settings.infrared.names)
    changed = ((each.features, each.weight) for each in task.learning.weights)
    weights = feature_weights(definition, changed, task.learning.history_weight, task.name)
    features = feature_table(definition, settings, weights if weighted else np.ones_like(weights), task)
    drive = build_drive_settings(settings, task)
    if unknown := sorted(set(load_task_repertoire(task, settings)) - set(drive.actions)):
        raise refused(task, f"action {', '.join(unknown)}")
    return drive, features


def build_drive_settings(
    settings: RobotSettings, task: TaskSettings, minimum_ticks: int | None = None
) -> DriveSettings:
    """Return the actions of the task's repertoire that a batch knows, and the minimum time of an action.

    `minimum_ticks`: that time in ticks; None: the task's.
    """
    actions = {name: _action_of(each) for name, each in load_task_repertoire(task, settings).items()}
    return DriveSettings(
        actions={name: each for name, each in actions.items() if each is not None},
        minimum_ticks=round(task.learning.minimum_action_s / settings.cycle_s)
        if minimum_ticks is None
        else minimum_ticks,
        behaviours=task.behaviours,
    )


def _action_of(behaviour: Behaviour) -> Action | None:
    """Return an action of the repertoire as numbers; None for a taught one."""
    match behaviour:
        case MotorPrimitive():
            return FixedSpeeds(*behaviour.wheel_speeds)
        case KeepDistance():
            return WallDistance(behaviour.front, behaviour.back, *behaviour.numbers)
        case TurnByAngle():
            return Turn(behaviour.wanted_m, *behaviour.turning)
    return None


def build_minds(
    simulations: Sequence[FollowedSimulation],
    settings: RobotSettings,
    task: TaskSettings,
    setups: Sequence[ExamSetup],
) -> list[Mind]:
    """Return the mind of each exam; equal knowledge makes one mind.

    Raises:
        BatchRefusedError: the batch does not know the policy or a feature.
        SettingsError: settings do not fit each other.
        UnknownActionError, UnknownBehaviourError: the knowledge does not fit the task.
    """
    policy = task.policy.build(settings.infrared)
    minds: list[Mind] = []
    taught: dict[tuple[int, int, int], TaughtMind] = {}
    for simulation, setup in zip(simulations, setups, strict=True):
        if setup.teacher_policy:
            if not isinstance(policy, TabledPolicy):
                raise refused(task, f"policy {task.policy.kind}")
            minds.append(PolicyMind(policy))
            continue
        if setup.learners is not None:
            definition = load_situation(task.situation, settings.infrared.names)
            features = feature_table(definition, settings, np.ones(definition.dimensions), task)
            minds.append(CallbackMind(choice_of(setup.learners, task, taught=lambda: False), features))
            continue
        key = id(setup.events), id(setup.saved), id(setup.autonomous_values)
        if key not in taught:
            runtime = build_exam_runtime(simulation, settings, task, setup, RuntimeOptions())
            taught[key] = _taught_mind(runtime, settings, task)
        minds.append(taught[key])
    return minds


def choice_of(team: LearnerTeam, task: TaskSettings, *, taught: Callable[[], bool]) -> Choose:
    """Return the function by which learners choose a compiled robot's actions.

    It raises BatchRefusedError if a learner fails. `taught`: returns whether a teacher is there who answers.
    """

    def choose(behaviour: str, situation: NDArray[np.float64]) -> str | None:
        action = team.decide(behaviour, situation, taught=taught())
        if team.failure:
            raise refused(task, f"a learner that failed ({team.failure})")
        return action

    return choose


def _taught_mind(runtime: Runtime, settings: RobotSettings, task: TaskSettings) -> TaughtMind:
    """Return the RLAs that answer in an exam: without withdrawn ones, and guesses that a task passes over."""
    level, definition = runtime.level, runtime.definition
    system, features = level.system, feature_table(definition, settings, level.system.weights, task)
    values = len(features.weights) + len(features.average_weights)
    known = [[rla for rla in system.candidates(each) if not system.passes_over(rla)] for each in task.behaviours]
    rlas = [rla for each in known for rla in each]
    place = {rla.key: index for index, rla in enumerate(rlas)}
    groups = [system.competitors(rla) for rla in rlas]
    would_answer = [level.would_answer(group) for group in groups]
    answers = [place[rla.key] for rla in would_answer]
    conditions = [(np.array(rla.condition, dtype=np.float64) * system.weights)[:values].tolist() for rla in rlas]
    return TaughtMind(
        sizes=tuple(map(len, known)),
        rla_ids=tuple(rla.rla_id for rla in rlas),
        conditions=conditions,
        radii=tuple(system.whole_radius(rla) for rla in rlas),
        answers=tuple(answers),
        actions=tuple(rla.action for rla in rlas),
        features=features,
    )


def feature_table(
    definition: SituationDefinition, settings: RobotSettings, weights: NDArray[np.float64], task: TaskSettings
) -> FeatureTable:
    """Return the features of a situation with their weights (d,), dimensionless. Raises BatchRefusedError."""
    place = {name: index for index, name in enumerate(settings.infrared.names)}
    kinds, sensors = [], []
    for feature in definition.features:
        kind = feature.batch_kind(definition.wheel_speed_counts_per_m_s)
        if kind is None:
            raise refused(task, f"{feature.name} in a situation")
        kinds.append(kind)
        sensors.append(tuple(place[name] for name in feature.sensors_used))
    recent, averages = weights[: len(kinds)].tolist(), weights[len(kinds) :].tolist()
    average_weights = tuple(averages) if any(averages) else ()
    return FeatureTable(tuple(kinds), tuple(sensors), tuple(recent), definition.history_steps, average_weights)


def refused(task: TaskSettings, what: str) -> BatchRefusedError:
    """Return the error of a task of which the batch does not know `what`; its advice is the CAN bus."""
    return BatchRefusedError(f"a batch does not know {what}", where=f"task {task.name}", do=_ON_THE_BUS)
