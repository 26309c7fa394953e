"""Kinds of plug-ins, and the parts of each kind."""

from enum import StrEnum
from typing import NamedTuple

from behaviors.registry import JUDGES, METRICS, POLICIES
from behaviors.repertoire_settings import BEHAVIOURS
from config.errors import UserError
from config.plugins import Plugin, PluginKind
from config.robot_plugins import ROBOTS, plugin_tasks
from config.settings_files import TASKS, WORLDS
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


class NoPluginError(UserError):
    """Name or folder that stands for no plug-in."""


class ListedPart(NamedTuple):
    """Part of a kind in a list."""

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
