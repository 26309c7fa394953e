"""Places of settings files: shipped, of a robot's plug-in, or kept with a run."""

import hashlib
from pathlib import Path
from typing import Final

from config import CONFIG_DIR
from config.errors import guess
from config.plugins import PluginError, PluginKind, UnknownPluginError, shelf
from config.robot_plugins import ROBOTS, find_robot_kind, is_robot, plugin_tasks
from config.settings import SettingsError

SHIPPED_DIR: Final = CONFIG_DIR
"""Folder of the files that ship with the project."""


YAML_SUFFIXES: Final = (".yaml", ".yml")
"""Endings of a settings file that is given by its path."""

FILES = "files"
"""Folder of the stored files that are no settings."""


def kept_name(name_or_path: str) -> str:
    """Return the name under which a run or a package keeps a file of settings: equal names, equal files.

    It is the shipped name, or a unique one for each path. It never leads out of a folder, because the author of a
    recorded run may be hostile.
    """
    path = Path(name_or_path)
    if not path.suffix and path.name == name_or_path:
        return f"{name_or_path}.yaml"
    return f"{path.stem}-{hashlib.sha256(name_or_path.encode()).hexdigest()[:8]}{path.suffix}"


def find_beside(settings: Path, name: str) -> Path:
    """Return the path of a file that settings name, such as a knowledge file of a repertoire; it need not exist.

    `settings`: path of the settings file. `name`: relative to its folder, absolute, or with a tilde.
    """
    kept = shelf().kept
    return settings.parent / Path(name).expanduser() if kept is None else kept / FILES / kept_name(name)


TASKS = PluginKind(
    "tasks",
    "task",
    "the path of a YAML file, as a str or Path",
    lambda found: isinstance(found, str | Path),
    lambda: shipped_names("tasks"),
)
WORLDS = PluginKind(
    "worlds",
    "world",
    "the path of a YAML file, or a function without arguments",
    lambda found: isinstance(found, str | Path) or callable(found),
    lambda: shipped_names("worlds"),
)


def find_config(kind: str, name_or_path: str) -> Path:
    """Return the path of a settings file: a path that exists, or the shipped `config/<kind>/<name>.yaml`.

    `<robot>/<name>` is a file of a robot's plug-in; its own settings go by `<robot>` alone. A task may also be a
    plug-in. Within `settings_from_elsewhere` a path is refused, because its file may name code. Raises SettingsError
    that lists the names when there is no such file.
    """
    kept = shelf().kept
    if kept is not None:
        path = kept / kind / kept_name(name_or_path)
        if path.is_file():
            return path
        raise SettingsError(f"is not among the settings in {kind} that were kept with the run", where=name_or_path)
    given = Path(name_or_path)
    if given.suffix in YAML_SUFFIXES and given.is_file() and shelf().is_own:
        return given
    names, folder = shipped_names(kind), CONFIG_DIR / kind
    # Compared and not joined: a folder and a foreign name together could lead anywhere. There are folders within.
    for path in folder.rglob("*.yaml"):
        if path.relative_to(folder).with_suffix("").as_posix() == name_or_path:
            return path
    of_robot = _file_of_robot(kind, name_or_path)
    if of_robot is not None:
        return of_robot
    plugins, is_name = "", given.suffix not in YAML_SUFFIXES
    if kind == ROBOTS.group:
        names += (each.name for each in ROBOTS.installed() if each.name not in names)
    if kind == TASKS.group:
        try:
            return plugin_file(str(TASKS.find(name_or_path)), name_or_path)
        except UnknownPluginError:
            names += (each.name for each in TASKS.installed())
            names += (each.name for each in plugin_tasks())
            plugins = "module:NAME, "
        except PluginError as error:
            raise SettingsError(error.what, where=error.where, do=error.do) from error
    near = guess(name_or_path if is_name else given.stem, names)
    raise SettingsError(
        f"no such name in {kind}" if is_name else "no such file",
        where=name_or_path,
        do=f"give {plugins}the path of a .yaml file, or one of: {', '.join(names)}{near}",
    )


def _file_of_robot(kind: str, name: str) -> Path | None:
    """Return the file that the plug-in of a robot has for `<robot>/<name>`; None for a name of another form.

    A robot's own settings go by the name of its kind alone, too. Raises SettingsError if the plug-in has no such file.
    """
    robot, _, rest = name.partition("/")
    if not rest and kind == ROBOTS.group:
        rest = robot
    if not rest.isidentifier() or not is_robot(robot):
        return None
    folder = find_robot_kind(robot).folder / kind
    if not (folder / f"{rest}.yaml").is_file():
        names = [f"{robot}/{path.stem}" for path in sorted(folder.glob("*.yaml"))]
        do = f"it has: {', '.join(names) or 'none'}{guess(name, names)}"
        raise SettingsError(f"the robot {robot} has no such file in {kind}", where=name, do=do)
    return folder / f"{rest}.yaml"


def plugin_file(path: str, name: str) -> Path:
    """Return the path of a file that a plug-in names. Raises SettingsError if there is no such file."""
    if not Path(path).is_file():
        raise SettingsError(f"its plug-in names the file {path}, which is not there", where=name, do="mend the plug-in")
    return Path(path)


def shipped_names(kind: str) -> list[str]:
    """Return the names of the shipped settings files in `config/<kind>`, without ending, sorted."""
    return sorted(path.stem for path in (CONFIG_DIR / kind).glob("*.yaml"))
