"""Kinds of robots as plug-ins, and the tasks in their folders."""

from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple, Protocol, cast

from config import CONFIG_DIR
from config.plugins import PluginError, PluginKind, import_target
from config.settings import SettingsError, content_of

_TASKS = "tasks"


class RobotParts(Protocol):
    """Settings of a kind of robot (simbridge.contracts.robot_kind.RobotKind has the rest)."""

    @property
    def settings(self) -> type[Any]:
        """Schema of the settings of such a robot, a subclass of hal.robot_settings.RobotSettings."""
        ...

    @property
    def folder(self) -> Path:
        """Folder of its YAML files, with the folders of `config`: robots, situations, tasks, ...."""
        ...


_ROBOT_PARTS = ("settings", "folder", "open", "simulations", "serve")
ROBOTS = PluginKind(
    "robots",
    "robot",
    f"an object with {', '.join(_ROBOT_PARTS[:-1])} and {_ROBOT_PARTS[-1]} (simbridge.contracts.robot_kind.RobotKind)",
    lambda found: all(hasattr(found, part) for part in _ROBOT_PARTS),
    tuple,
)
"""Kinds of robots. All are plug-ins, also those of the project."""


@cache
def _robot_kind(name: str) -> RobotParts:
    return cast("RobotParts", ROBOTS.find(name))


def find_robot_kind(name: str) -> RobotParts:
    """Return a kind of robot by its name, or by `module:Name`. Raises SettingsError."""
    try:
        return _robot_kind(name)
    except PluginError as error:
        raise SettingsError(error.what, where=error.where, do=error.do) from error


def is_robot(name: str) -> bool:
    """Return whether an installed plug-in offers a robot of this name; nothing is imported."""
    return name in {each.name for each in ROBOTS.installed()}


def robot_of_task(name: str) -> str | None:
    """Return the robot whose plug-in has a task, as in `school/fleeing`; None for a task by another name or a path."""
    robot, slash, _ = name.partition("/")
    return robot if slash and is_robot(robot) else None


_FIRST_TASK = "wall_following"


def find_task_of_robot(robot: str) -> str | None:
    """Return the first task to teach a robot of a plug-in, such as `school/wall_following`; None if it has none.

    Raises SettingsError for a plug-in that cannot be imported.
    """
    if not is_robot(robot):
        return None
    folder = find_robot_kind(robot).folder
    if folder == CONFIG_DIR:  # tasks of the project go by their names alone
        return None
    names = sorted(path.stem for path in (folder / _TASKS).glob("*.yaml"))
    if not names:
        return None
    return f"{robot}/{_FIRST_TASK if _FIRST_TASK in names else names[0]}"


class RobotTask(NamedTuple):
    """Task whose YAML file lies in the folder of a robot's plug-in, as `plugin_tasks` lists it."""

    name: str
    """Name on the command line, such as `school/fleeing`."""
    source: str
    """Distribution with its version."""
    path: Path


def plugin_tasks() -> list[RobotTask]:
    """Return the tasks in the folders of robots' plug-ins.

    A plug-in that cannot be imported offers none. Those of the project's own folder go by their names alone.
    """
    found = []
    for plugin in ROBOTS.installed():
        with suppress(PluginError):
            # Not by `find_robot_kind`: a recording names the plug-ins that were loaded, and these are only looked at.
            kind = cast("RobotParts", import_target(plugin.target, plugin.name))
            if (folder := kind.folder) != CONFIG_DIR:
                paths = sorted((folder / _TASKS).glob("*.yaml"))
                found += [RobotTask(f"{plugin.name}/{path.stem}", plugin.source, path) for path in paths]
    return found


def plugin_task(name: str) -> str | None:
    """Return the task of a robot's plug-in, such as `school/fleeing`, whose settings give it a name; or None."""
    for task in plugin_tasks():
        with suppress(SettingsError):
            content = content_of(task.path)
            if isinstance(content, dict) and content.get("name") == name:
                return task.name
    return None
