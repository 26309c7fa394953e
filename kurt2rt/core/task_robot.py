"""A task with the robot that is to drive it, which must have its sensors."""

from collections.abc import Mapping

from config.robot_plugins import robot_of_task
from config.settings import SettingsError
from hal.robot_settings import DEFAULT_ROBOT, RobotSettings, load_robot, load_robot_of, robot_that_task_names
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.task_settings import TaskSettings, load_task


def load_task_and_robot(
    name: str, robot: str | None, *, paper_defaults: bool = False, changes: Mapping[str, str] | None = None
) -> tuple[TaskSettings, RobotSettings]:
    """Load a task, and the robot that is to drive it.

    Args:
        name: of the task, or its path.
        robot: by name or path; None: the robot of the task.
        paper_defaults: take those of the task in place of `learning` (load_task).
        changes: of the task's keys (load_task).

    Raises:
        config.settings.SettingsError: one of them cannot be loaded, or the robot lacks sensors of the task.
    """
    settings = load_robot_of(robot, name)
    task = load_task(name, paper_defaults=paper_defaults, changes=changes)
    require_robot_of(task, name, settings)
    return task, settings


def require_robot_of(task: TaskSettings, name: str, robot: RobotSettings) -> None:
    """Check, before any training, that the robot has the sensors of a task.

    `name`: of the task on the command line, or its path.

    Raises:
        config.settings.SettingsError: it lacks some; the error names the robot that the task is for.
    """
    try:
        load_situation(task.situation, robot.infrared.names)
    except SettingsError as error:
        # A file without `robot` may still take its situation from a robot's plug-in, as a copy of such a task does.
        named, used = robot_that_task_names(name), robot_of_task(task.situation)
        other = named or used or DEFAULT_ROBOT
        if load_robot(other).kind == robot.kind:
            raise
        raise SettingsError(
            f"is for the robot {other} (got the robot {robot.kind}, which lacks its sensors)",
            where=f"task {name}",
            do=f"give --robot-settings {other}"
            + ("" if named or not used else f", or write robot: {other} in its file"),
        ) from error
