"""Plug-ins: parts from outside of the project, by an entry point of an installed package or by `module:Name`."""

import importlib
import sys
import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import lru_cache, reduce
from importlib import import_module, invalidate_caches
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from config.errors import UserError, guess

OWN_PACKAGES = ("config", "hal", "behaviors", "simbridge", "kurt2rt")
"""Top-level packages of the program; a part of any other one is a plug-in."""
_GROUPS = "kurt2rt."
_ERROR_LENGTH = 300


class PluginError(UserError, ValueError):
    """Plug-in that is not found, cannot be imported, or does not fit its kind."""


class UnknownPluginError(PluginError):
    """Name that leads to no plug-in; its `do` lists the names."""


class Plugin(NamedTuple):
    """Entry point of a plug-in, found but not necessarily imported."""

    group: str
    """Kind, such as policies."""
    name: str
    """Name in settings and on the command line."""
    target: str
    """`module:Name`."""
    source: str
    """Distribution with its version; once it is loaded by `module:Name`, its file."""


_LOADED: dict[tuple[str, str], Plugin] = {}


class Shelf(NamedTuple):
    """Places from which settings and plug-ins come."""

    is_own: bool = True
    """False for settings from elsewhere, whose author may be hostile."""
    kept: Path | None = None
    """Folder of the files that were stored with a run or package, which are then found alone."""


_OWN = Shelf()
# Settings from elsewhere are loaded in a few places. A parameter would pass through all loaders and all validators.
_SHELF: ContextVar[Shelf] = ContextVar("shelf", default=_OWN)


@contextmanager
def settings_from_elsewhere(kept: Path | None = None) -> Iterator[None]:
    """Refuse imports by `module:Name` while the context lasts, because the author of the settings may be hostile.

    Plug-ins that are installed, or that this process loaded before, are still found. `kept`: folder of the only files
    that are found; None: as around this context.
    """
    token = _SHELF.set(Shelf(is_own=False, kept=kept or shelf().kept))
    try:
        yield
    finally:
        _SHELF.reset(token)


def shelf() -> Shelf:
    """Return the places that are in force."""
    return _SHELF.get()


def installed_plugins(group: str) -> list[Plugin]:
    """Return the plug-ins of a kind, such as policies, that installed packages offer, by name; nothing is imported."""
    return list(_installed(tuple(map(_entry_of_path, sys.path))).get(group, ()))


def loaded_plugins() -> tuple[Plugin, ...]:
    """Return the plug-ins that this process loaded, in that order."""
    return tuple(_LOADED.values())


@dataclass(frozen=True, slots=True)
class PluginKind:
    """Kind of parts that plug-ins may offer. Its registry finds the shipped parts, before it asks here."""

    group: str
    """Plural, such as policies; the entry points are those of `kurt2rt.policies`."""
    one: str
    """Singular, for texts."""
    allowed: str
    """Description of what `fits` takes, with an article."""
    fits: Callable[[object], bool]
    """Returns whether an imported object is a part of this kind."""
    shipped: Callable[[], Iterable[str]]
    """Returns the names of the shipped parts."""

    def installed(self) -> list[Plugin]:
        """Return the plug-ins that the entry points of installed packages offer, by name; nothing is imported."""
        return installed_plugins(self.group)

    def find(self, name: str) -> object:
        """Import and return the plug-in of a name, or of `module:Name` on Python's path or in the current folder.

        Raises:
            UnknownPluginError: nothing is found by this name.
            PluginError: two packages offer the name, the import fails, or the object is none of this kind.
        """
        plugin = self._plugin(name)
        found = import_target(plugin.target, self._where(name))
        if not self.fits(found):
            told = f"{plugin.target} is {_described(found)}, allowed is {self.allowed}"
            raise PluginError(told, where=self._where(name), do="name another one, or mend it")
        if plugin.target == name:
            module = sys.modules[name.partition(":")[0]]
            plugin = plugin._replace(source=str(module.__file__ or module.__name__))
        _LOADED[self.group, name] = plugin
        return found

    def _plugin(self, name: str) -> Plugin:
        offered = self.installed()
        named = [each for each in offered if each.name == name]
        if len(named) > 1:
            packages = " and ".join(each.source for each in named)
            raise PluginError(
                f"{packages} both offer this name", where=self._where(name), do="uninstall one, or give module:Name"
            )
        if named:
            return named[0]
        if not is_target(name):
            raise self._unknown(name, [*self.shipped(), *(each.name for each in offered)])
        is_known = (self.group, name) in _LOADED or any(each.target == name for each in offered)
        if not shelf().is_own and not is_known:
            raise PluginError(
                "settings from a recording or package may not import it",
                where=self._where(name),
                do=f"install it as a package with an entry point of {_GROUPS}{self.group}",
            )
        return Plugin(self.group, name, name, "")

    def _unknown(self, name: str, names: list[str]) -> UnknownPluginError:
        return UnknownPluginError(
            f"there is no such {self.one}",
            where=self._where(name),
            do=f"give module:Name, or one of: {', '.join(names)}{guess(name, names)}",
        )

    def _where(self, name: str) -> str:
        return f"{self.one} {name}"


def import_target(target: str, where: str, do: str = "") -> object:
    """Import and return the object that `module:Name` names.

    A module that is not on Python's path is searched in the current folder, which then stays at the path's end: the
    processes of a study take the path over, and find the module as well.

    Args:
        target: `module:Name`; dots within the name lead to attributes.
        where: what is looked for, for errors.
        do: remedy of a module that cannot be imported; the file is to be mended by default.

    Raises PluginError, with the file and line of an error within the module.
    """
    module_name, _, attribute = target.partition(":")
    try:
        module = _import_here(module_name)
    except (Exception, SystemExit) as error:
        if isinstance(error, ModuleNotFoundError) and _is_within(module_name, error.name or ""):
            told = f"there is no module {error.name!r} on Python's path or in {Path.cwd()}"
            raise PluginError(told, where=where, do=do or "give a module that Python finds from this folder") from error
        told = f"{module_name} cannot be imported: {_first_cause(error)}"
        raise PluginError(told, where=where, do=do or "mend it, or install what it needs") from error
    try:
        found: object = reduce(getattr, attribute.split("."), module)
    except AttributeError as error:
        told = f"{module.__file__ or module_name} has no {attribute!r}"
        raise PluginError(told, where=where, do="name what stands in that file") from error
    return found


def _entry_of_path(folder: str) -> tuple[str, int]:
    """Return a folder of Python's path with the time of its newest change, in ns; 0 if it is not there."""
    try:
        return folder, Path(folder).stat().st_mtime_ns
    except OSError:
        return folder, 0


@lru_cache(maxsize=8)
def _installed(path: tuple[tuple[str, int], ...]) -> dict[str, list[Plugin]]:  # noqa: ARG001 - the key of the cache
    """Return the plug-ins of each kind. All packages are read once, which takes 2 to 20 ms, until one is installed."""
    offered = entry_points()
    groups = [each.removeprefix(_GROUPS) for each in offered.groups if each.startswith(_GROUPS)]
    return {
        group: sorted(_of_entry_point(group, point) for point in offered.select(group=_GROUPS + group))
        for group in groups
    }


def _of_entry_point(group: str, point: EntryPoint) -> Plugin:
    source = f"{point.dist.name} {point.dist.version}" if point.dist is not None else "an unknown package"
    return Plugin(group, point.name, f"{point.module}:{point.attr}", source)


def is_target(name: str) -> bool:
    """Return whether a name has the form `module:Name`."""
    parts = name.split(":")
    return len(parts) == 2 and all(each.isidentifier() for part in parts for each in part.split("."))


def _is_within(module: str, package: str) -> bool:
    return module == package or module.startswith(f"{package}.")


def _import_here(name: str) -> ModuleType:
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        folder = str(Path.cwd())
        if folder in sys.path or not _is_within(name, error.name or ""):
            raise
    # At the end: a file of this folder must not replace a module that some other package imports later.
    sys.path.append(folder)
    invalidate_caches()
    try:
        return import_module(name)
    except BaseException:
        sys.path.remove(folder)
        raise


def _first_cause(error: BaseException) -> str:
    """Return the file, line and text of an error that a module raised while it was imported."""
    text = " ".join(f"{type(error).__name__}: {error}".split())[:_ERROR_LENGTH]
    if isinstance(error, SyntaxError):
        return f"{error.filename}, line {error.lineno}: {type(error).__name__}: {error.msg}"
    frames = [
        frame
        for frame in traceback.extract_tb(error.__traceback__)
        if not frame.filename.startswith("<frozen importlib") and frame.filename not in (__file__, importlib.__file__)
    ]
    return f"{frames[-1].filename}, line {frames[-1].lineno}: {text}" if frames else text


def _described(found: object) -> str:
    if isinstance(found, type):
        return f"the class {found.__name__}"
    return f"a {type(found).__name__}"
