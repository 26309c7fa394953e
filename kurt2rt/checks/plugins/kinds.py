"""Kinds of plug-ins, the parts of each kind, and their texts: YAML, or the source of a class."""

import inspect
from enum import StrEnum
from pathlib import Path
from typing import Any, NamedTuple, get_args

from behaviors import repertoire_settings
from behaviors.judges.judge import JudgeSettings
from behaviors.metrics.task_metric import MetricSettings
from behaviors.policies.policy import PolicySettings
from behaviors.registry import JUDGES, METRICS, POLICIES
from behaviors.repertoire_settings import BEHAVIOURS
from config.errors import UserError
from config.plugins import Plugin, PluginError, PluginKind
from config.robot_plugins import ROBOTS, plugin_tasks
from config.settings import SettingsError
from config.settings_by_kind import KindSettings, find_kind
from config.settings_files import TASKS, WORLDS, find_config, plugin_file
from kurt2rt.core.learner.learners import LEARNERS, find_learner


class KindName(StrEnum):
    """Kind of plug-ins, as `kurt2rt plugin` names it on the command line."""

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


class NoPluginError(UserError):
    """Name or folder, given to `kurt2rt plugin`, that stands for no plug-in."""


class ListedPart(NamedTuple):
    """Line of the list of plug-ins: a part of one kind, shipped or from an installed package."""

    kind: str
    name: str
    source: str
    """kurt2rt, or a distribution with its version."""
    note: str
    """Reason why the name does not lead to it; empty if it does."""


def list_parts(kind: PluginKind) -> list[ListedPart]:
    """Return the shipped and the installed parts of a kind; nothing is imported, except robots for their tasks."""
    shipped, installed = sorted(kind.shipped()), kind.installed()
    names = [each.name for each in installed]
    listed = [ListedPart(kind.group, name, "kurt2rt", "") for name in shipped]
    if kind is TASKS:
        listed += [ListedPart(kind.group, each.name, each.source, "") for each in plugin_tasks()]
    noted = (ListedPart(kind.group, each.name, each.source, _note(each, shipped, names)) for each in installed)
    return [*listed, *noted]


def _note(plugin: Plugin, shipped: list[str], names: list[str]) -> str:
    if plugin.name in shipped:
        return "hidden by the shipped one"
    return "refused: two packages offer this name" if names.count(plugin.name) > 1 else ""


class TextKind(StrEnum):
    """Kind of parts with a text, on the command line: the kinds of plug-ins, and files that tasks name."""

    LEARNERS = "learners"
    POLICIES = "policies"
    JUDGES = "judges"
    METRICS = "metrics"
    BEHAVIOURS = "behaviours"
    TASKS = "tasks"
    WORLDS = "worlds"
    ROBOTS = "robots"
    REPERTOIRES = "repertoires"
    SITUATIONS = "situations"


_BY_KIND: dict[str, tuple[str, type[KindSettings], PluginKind]] = {
    POLICIES.group: ("behaviors.policies", PolicySettings, POLICIES),
    JUDGES.group: ("behaviors.judges", JudgeSettings, JUDGES),
    METRICS.group: ("behaviors.metrics", MetricSettings, METRICS),
}


def text_of_part(kind: str, name: str) -> str:
    """Return the text of the file that holds a part: YAML, or Python.

    `kind`: a value of TextKind. `name`: shipped, installed, `module:Name`, or `<robot>/<name>` for a robot's files.

    Raises:
        NoPluginError: there is no such part, or its source is not in a file.
        UserError: its plug-in cannot be loaded.
    """
    if kind == LEARNERS.group:
        return _source_of(find_learner(name), name)
    if kind == BEHAVIOURS.group:
        return _text_of_action(name)
    if kind == WORLDS.group:
        return _text_of_world(name)
    if kind in _BY_KIND:
        package, base, plugins = _BY_KIND[kind]
        try:
            return _source_of(find_kind(package, name, base, plugins), name)
        except PluginError as error:
            raise NoPluginError(error.what, where=error.where, do=error.do) from error
        except ValueError as error:
            raise NoPluginError(str(error), where=name) from error
    return _text_of(find_config(kind, name))


def _text_of_action(name: str) -> str:
    if name not in BEHAVIOURS.shipped():
        return _source_of(BEHAVIOURS.find(name), name)
    return next(
        inspect.getsource(found)
        for found in vars(repertoire_settings).values()
        if name in get_args(getattr(found, "__annotations__", {}).get("kind"))
    )


def _text_of_world(name: str) -> str:
    try:
        return _text_of(find_config(WORLDS.group, name))
    except SettingsError as error:
        # Names of the project and of robots are files; an installed world may be a file or a function.
        if name not in {each.name for each in WORLDS.installed()} and ":" not in name:
            raise NoPluginError(error.what, where=error.where, do=error.do) from error
    found = WORLDS.find(name)
    return _text_of(plugin_file(str(found), name)) if isinstance(found, str | Path) else _source_of(found, name)


def _source_of(part: Any, name: str) -> str:
    try:
        path = inspect.getsourcefile(part)
    except TypeError:
        path = None
    if path is None:
        raise NoPluginError("its source is not in a file of Python", where=name, do="see its package")
    return _text_of(Path(path))


def _text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8")
