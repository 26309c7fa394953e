"""Learners of other authors in a simulated robot."""

from config.errors import UserError
from hal.robot_settings import RobotSettings, load_robot_of
from kurt2rt.core.learner.learner import LearnerFactory, LearnerSetting
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.lockstep.learner_setting import learner_setting as setting_of


def learner_setting(
    task: str = "wall_following", *, robot: str | None = None, seed: int = 1, gate: float | None = None
) -> LearnerSetting:
    """Return the setting that a learner of a task is made with: actions, weights, R and the rest.

    Args:
        task: name or path of the task.
        robot: name or path of the robot's settings; None: the robot of the task.
        seed: of all that the learner draws.
        gate: number by which it asks, dimensionless or in counts as the learner says; None: its default.

    Raises:
        UserError: as kurt2rt.Error, a name is unknown, or settings do not fit.
    """
    return setting_of(load_task(task), load_robot_of(robot, task), seed=seed, gate=gate)


def new_team(make: LearnerFactory | None, task: TaskSettings, robot: RobotSettings, seed: int) -> LearnerTeam | None:
    """Return the learner of a task with one behaviour, which knows nothing; None without a maker."""
    if make is None:
        return None
    name = getattr(make, "__name__", type(make).__name__)
    return LearnerTeam(name, make, setting_of(task, robot, seed=seed), task.behaviours)


def require_alone(make: LearnerFactory | None, **others: object) -> None:
    """Raise UserError if a learner is given with what only RLAs can use; `others`: by name, None if absent."""
    given = [name for name, value in others.items() if value is not None]
    if make is not None and given:
        raise UserError(
            f"is for RLAs alone (got a learner and {given[0]})", where=given[0], do=f"leave out learner or {given[0]}"
        )
