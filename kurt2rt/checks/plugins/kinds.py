"""Kinds of plug-ins, and the plug-ins that a name, a folder or a file stands for."""

import inspect
import sys
import tomllib
from enum import StrEnum
from pathlib import Path
from typing import NamedTuple

from behaviors.registry import JUDGES, METRICS, POLICIES
from behaviors.repertoire_settings import BEHAVIOURS
from hal.errors import UserError
from hal.plugins import Plugin, PluginKind, import_target, is_target
from hal.robot_plugins import ROBOTS, robot_of_task, robots_tasks
from hal.robot_settings import robot_that_task_names
from hal.settings import SettingsError, content_of
from hal.settings_files import TASKS, WORLDS, YAML_SUFFIXES
from kurt2rt.checks.plugins.folder_robots import robots_by_part
from kurt2rt.core.learner.learners import LEARNERS


class KindName(StrEnum):
    """Kind of plug-ins, on the command line."""

    LEARNERS = "learners"
    POLICIES = "policies"
    JUDGES = "judges"
    METRICS = "metrics"
    BEHAVIOURS = "behaviours"
    TASKS = "tasks"
    WORLDS = "worlds"
    ROBOTS = "robots"


KINDS: dict[str, PluginKind] = {
    each.group: each for each in (LEARNERS, POLICIES, JUDGES, METRICS, BEHAVIOURS, TASKS, WORLDS, ROBOTS)
}
"""All kinds of plug-ins by the names of their groups."""
_KEYS_OF_WORLDS = {"outline", "image", "map"}
_GROUPS = "kurt2rt."


class NoPluginError(UserError):
    """Name, folder or file that stands for no plug-in."""


class Subject(NamedTuple):
    """Plug-in to check."""

    group: str
    name: str
    """Name or `module:Name`; the path of a task's or a world's file."""
    robot: str | None = None
    """Robot that it is for, by name or path; None if nothing says so."""


class Listed(NamedTuple):
    """Part of a kind in a list."""

    kind: str
    name: str
    source: str
    """kurt2rt, or a distribution with its version."""
    note: str
    """Reason why the name does not lead to it; empty if it does."""


def list_parts(kind: PluginKind) -> list[Listed]:
    """Return the shipped and the installed parts of a kind; nothing is imported, except robots for their tasks."""
    shipped, installed = sorted(kind.shipped()), kind.installed()
    names = [each.name for each in installed]
    listed = [Listed(kind.group, name, "kurt2rt", "") for name in shipped]
    if kind is TASKS:
        listed += [Listed(kind.group, each.name, each.source, "") for each in robots_tasks()]
    return [*listed, *(Listed(kind.group, each.name, each.source, _note(each, shipped, names)) for each in installed)]


def find_subjects(name_or_path: str, group: str | None = None) -> list[Subject]:
    """Return the plug-ins that a name, `module:Name`, a folder with a pyproject.toml or a YAML file stands for.

    `group`: the kind that is meant, such as policies; None: found out.

    Raises:
        NoPluginError: there is none, or several kinds fit.
        PluginError: `module:Name` cannot be imported.
    """
    path = Path(name_or_path)
    if path.is_dir():
        return _subjects_in(path)
    found = _subject_of(name_or_path, path, group)
    return [found._replace(robot=robot_that_task_names(name_or_path)) if found.group == TASKS.group else found]


def _subject_of(name_or_path: str, path: Path, group: str | None) -> Subject:
    if path.suffix in YAML_SUFFIXES:
        return Subject(group or _group_of_file(path), name_or_path)
    if group is not None:
        return Subject(group, name_or_path)
    if is_target(name_or_path):
        return Subject(_group_of_part(name_or_path), name_or_path)
    if robot_of_task(name_or_path) is not None:
        return Subject(TASKS.group, name_or_path)
    found = [each for kind in KINDS.values() for each in list_parts(kind) if each.name == name_or_path]
    groups = {each.kind for each in found}
    if not groups:
        raise NoPluginError(
            "there is no such plug-in",
            where=name_or_path,
            do="give module:Name, a folder, a YAML file, or a name of kurt2rt plugin list",
        )
    if len(groups) > 1:
        raise _several(name_or_path, groups)
    return Subject(groups.pop(), name_or_path)


def _note(plugin: Plugin, shipped: list[str], names: list[str]) -> str:
    if plugin.name in shipped:
        return "hidden by the shipped one"
    return "refused: two packages offer this name" if names.count(plugin.name) > 1 else ""


def _subjects_in(folder: Path) -> list[Subject]:
    file = folder / "pyproject.toml"
    try:
        project = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise NoPluginError(f"cannot be read: {error}", where=file, do="give a folder with a pyproject.toml") from error
    groups = project.get("project", {}).get("entry-points", {})
    offered = [
        (group, name, target)
        for group in KINDS
        for name, target in groups.get(_GROUPS + group, {}).items()
        if isinstance(target, str)
    ]
    if not offered:
        kinds = ", ".join(_GROUPS + group for group in KINDS)
        raise NoPluginError("offers no plug-in", where=file, do=f"add an entry point of one of: {kinds}")
    sys.path[:0] = [str(each.resolve()) for each in (folder, folder / "src") if each.is_dir()]
    robots = robots_by_part(folder)
    return [
        Subject(
            group,
            target,
            robot_that_task_names(target) if group == TASKS.group else robots.get(target, robots.get(name)),
        )
        for group, name, target in offered
    ]


def _group_of_file(path: Path) -> str:
    try:
        content = content_of(path)
    except SettingsError as error:
        raise NoPluginError(error.what, where=error.where, do=error.do) from error
    is_world = isinstance(content, dict) and _KEYS_OF_WORLDS & content.keys()
    return WORLDS.group if is_world else TASKS.group


def _group_of_part(target: str) -> str:
    found = import_target(target, target)
    if isinstance(found, str | Path):
        return _group_of_file(Path(found))
    # Any class or function could make learners or worlds.
    kinds = [kind for kind in KINDS.values() if kind is not WORLDS and kind.fits(found)]
    if inspect.isfunction(found):
        needs = [each for each in inspect.signature(found).parameters.values() if each.default is each.empty]
        kinds = [LEARNERS] if needs else [WORLDS]
    if len(kinds) == 1:
        return kinds[0].group
    raise _several(target, {each.group for each in kinds or KINDS.values()})


def _several(name: str, groups: set[str]) -> NoPluginError:
    return NoPluginError("its kind is not clear", where=name, do=f"give --kind, one of: {', '.join(sorted(groups))}")
