"""Plug-ins that the command line finds in the current folder and a service would not."""

import os
import sys
from collections.abc import Iterator
from importlib.machinery import PathFinder
from pathlib import Path

from hal.plugins import Plugin, is_target, loaded_plugins


def plugins_of_this_folder() -> Iterator[Plugin]:
    """Yield each plug-in loaded by `module:Name` whose module is neither installed nor part of Python.

    A service runs in a folder of its own, without PYTHONPATH, so it would not find that module.
    """
    for plugin in loaded_plugins():
        if is_target(plugin.name) and not _is_installed(plugin.name.partition(":")[0].partition(".")[0]):
            yield plugin


def _is_installed(module: str) -> bool:
    mine = {Path.cwd(), *(Path(each).absolute() for each in os.environ.get("PYTHONPATH", "").split(os.pathsep) if each)}
    path = [each for each in sys.path if Path(each).absolute() not in mine]
    finders = (each for each in sys.meta_path if each is not PathFinder and hasattr(each, "find_spec"))
    # Other finders than that of the path are those of built-in modules and of packages installed for editing.
    return PathFinder.find_spec(module, path) is not None or any(each.find_spec(module, None) for each in finders)
