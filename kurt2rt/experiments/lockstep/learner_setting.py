"""Setting of the learners of a task."""

from hal.robot_settings import RobotSettings
from kurt2rt.core.learner.learner import LearnerSetting
from kurt2rt.core.perception.definition import feature_weights, load_situation
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.knowledge.task_repertoire import load_task_repertoire


def learner_setting(
    task: TaskSettings, robot: RobotSettings, *, seed: int, gate: float | None = None
) -> LearnerSetting:
    """Return the setting of a learner of a task.

    Args:
        task: whose features, weights and repertoire it gets.
        robot: that it drives.
        seed: of all that it draws.
        gate: number by which it asks, dimensionless or in counts as the learner says; None: its default.

    Raises:
        config.settings.SettingsError: settings do not fit each other.
    """
    definition, learning = load_situation(task.situation, robot.infrared.names), task.learning
    changed = ((each.features, each.weight) for each in learning.weights)
    return LearnerSetting(
        dimensions=definition.dimensions,
        weights=feature_weights(definition, changed, learning.history_weight, task.name),
        radius=learning.radius,
        ask_radius_fraction=learning.ask_radius_fraction,
        insert_radius_fraction=learning.insert_radius_fraction,
        actions=tuple(load_task_repertoire(task, robot)),
        seed=seed,
        gate=gate,
    )
