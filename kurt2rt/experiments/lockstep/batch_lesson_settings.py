"""Settings of a lesson in a batch, and the refusal of lessons that a batch does not know."""

import numpy as np

from hal.batch import Choose, TabledPolicy
from hal.batch_lesson import LessonDriveSettings
from hal.robot_settings import RobotSettings
from kurt2rt.core.perception.definition import feature_weights, load_situation
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.batch_mind import (
    build_drive_settings,
    feature_table,
    refused,
    require_known_robot,
    require_known_task,
)
from kurt2rt.experiments.lockstep.lesson_plan import plan_of
from kurt2rt.knowledge.task_repertoire import load_task_repertoire


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
        hal.settings.SettingsError: settings of the task do not fit each other.
    """
    require_known_robot(settings, task)
    require_known_task(task)
    doubt = task.learning.doubt
    if doubt is not None and doubt.asks:
        raise refused(task, "a robot that asks at a doubt")
    policy = task.policy.build(settings.infrared)
    if not isinstance(policy, TabledPolicy):
        raise refused(task, f"policy {task.policy.kind}")
    definition = load_situation(task.situation, settings.infrared.names)
    changed = ((each.features, each.weight) for each in task.learning.weights)
    weights = feature_weights(definition, changed, task.learning.history_weight, task.name)
    drive = build_drive_settings(settings, task)
    unknown = sorted(set(load_task_repertoire(task, settings)) - set(drive.actions))
    if unknown:
        raise refused(task, f"action {', '.join(unknown)}")
    return LessonDriveSettings(
        actions=dict(drive.actions),
        minimum_ticks=drive.minimum_ticks,
        behaviours=task.behaviours,
        policy=policy,
        features=feature_table(definition, settings, weights if choose is None else np.ones_like(weights), task),
        ticks=round(plan_of(task).duration_s / settings.cycle_s),
        choose=choose,
    )
