"""Check that a task is driven by a robot with its sensors."""

from hal.robot_plugins import robot_of_task
from hal.robot_settings import DEFAULT_KIND, RobotSettings, load_robot, robot_that_task_names
from hal.settings import SettingsError
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.task_settings import TaskSettings


def require_robot_of(task: TaskSettings, name: str, robot: RobotSettings) -> None:
    """Check, before any training, that the robot has the sensors of a task.

    `name`: of the task on the command line, or its path.

    Raises:
        hal.settings.SettingsError: it lacks some; the error names the robot that the task is for.
    """
    try:
        load_situation(task.situation, robot.infrared.names)
    except SettingsError as error:
        # A file without `robot` may still take its situation from a robot's plug-in, as a copy of such a task does.
        named, used = robot_that_task_names(name), robot_of_task(task.situation)
        other = named or used or DEFAULT_KIND
        if load_robot(other).kind == robot.kind:
            raise
        raise SettingsError(
            f"is for the robot {other} (got the robot {robot.kind}, which lacks its sensors)",
            where=f"task {name}",
            do=f"give --robot-settings {other}"
            + ("" if named or not used else f", or write robot: {other} in its file"),
        ) from error
