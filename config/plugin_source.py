"""Hash of a plug-in's source, with the files next to it that it imports."""

import ast
import hashlib
import sys
from pathlib import Path

from config.plugins import OWN_PACKAGES, loaded_plugins

_INSTALLED = frozenset({"site-packages", "dist-packages"})
"""Folders in which strangers' packages lie next to a plug-in."""
_COMPILED = "__pycache__"
_DIGITS = 8
"""Hexadecimal digits of a hash that a person compares."""


def plugins_in_use() -> tuple[str, ...]:
    """Return a text for each plug-in that this process loaded: kind, name, package with version or file, and hash.

    Those that ship with the project are left out: its version names them.
    """
    told = []
    for plugin in loaded_plugins():
        source_hash = _hash_of_module(plugin.target.partition(":")[0])
        if source_hash:
            told.append(f"{plugin.group} {plugin.name} from {plugin.source}, hash {source_hash[:_DIGITS]}")
    return tuple(told)


def source_hash_of(part: object) -> str:
    """Return a hash that changes with the source of a plug-in; empty for a part of the project.

    It covers all files of the top-level package, or the single file, that defines the class or function. It covers
    modules and packages in the same folder, too, that these import, directly or not.
    """
    return _hash_of_module(getattr(part, "__module__", None) or type(part).__module__)


def _hash_of_module(name: str) -> str:
    top = name.partition(".")[0]
    module = sys.modules.get(top)
    file = getattr(module, "__file__", None)
    # A package without __init__.py has folders instead.
    path = Path(file) if file is not None else next(map(Path, getattr(module, "__path__", ())), None)
    if top in OWN_PACKAGES or path is None:
        return ""
    folder = path.parent.parent if path.name == "__init__.py" else path.parent
    digest = hashlib.sha256()
    for each in sorted(_files_of(top, folder)):
        digest.update(f"{each.relative_to(folder).as_posix()}\0".encode())
        digest.update(each.read_bytes())
    return digest.hexdigest()


def _files_of(top: str, folder: Path) -> set[Path]:
    """Return the files of a top-level module of a folder, and of those next to it that it needs."""
    found: set[Path] = set()
    others = set() if folder.name in _INSTALLED else _modules_in(folder) - {top}
    waiting = [top]
    while waiting:
        files = _own_files(folder / waiting.pop())
        found.update(files)
        needed = {name for file in files if file.suffix == ".py" for name in _imported(file, others)}
        others -= needed
        waiting += needed
    return found


def _modules_in(folder: Path) -> set[str]:
    """Return the names of the modules and packages in a folder, those of Python and of the project aside."""
    names = {each.stem for each in folder.glob("*.py")} | {each.parent.name for each in folder.glob("*/*.py")}
    return names - sys.stdlib_module_names - set(OWN_PACKAGES)


def _own_files(path: Path) -> list[Path]:
    """Return the file of a module, or all files of a package."""
    file = path.with_name(f"{path.name}.py")
    if file.is_file() and not (path / "__init__.py").is_file():
        return [file]
    return [each for each in path.rglob("*") if each.is_file() and _COMPILED not in each.parts]


def _imported(file: Path, names: set[str]) -> set[str]:
    """Return which of these top-level modules a file imports, also within functions."""
    text = file.read_text(encoding="utf-8", errors="replace")
    if not any(name in text for name in names):  # parsing takes milliseconds a file
        return set()
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError):  # a template, which is never imported
        return set()
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found.add(node.module.partition(".")[0])
    return found & names
