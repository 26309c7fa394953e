"""Import graph of the program: the modules that a module needs, read from the source without importing any."""

import ast
from collections.abc import Iterable, Iterator
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

from hal.plugins import OWN_PACKAGES

PACKAGES = OWN_PACKAGES
"""Top-level packages of the program; all others come with the environment."""


def modules_needed(roots: Iterable[str]) -> dict[str, Path]:
    """Return the file of each module of the program that the roots import, directly or not, and of the roots.

    Imports within functions count, imports for type checkers alone do not. A text that is the full name of a
    sub-package, such as "behaviors.policies", stands for all of its modules: settings choose one by its kind.

    Args:
        roots: full names of modules; names outside the program are ignored.

    Returns:
        Files by the full names of the modules, sorted.
    """
    needed: dict[str, Path] = {}
    waiting = list(roots)
    while waiting:
        name = waiting.pop()
        path = None if name in needed else _file_of(name)
        if path is None:
            continue
        needed[name] = path
        waiting += _names_in(path.read_text(encoding="utf-8"))
        waiting.append(name.rpartition(".")[0])
    return dict(sorted(needed.items()))


@lru_cache(maxsize=1024)
def _names_in(text: str) -> frozenset[str]:
    """Return the full names that may be modules: imported ones, and the modules of sub-packages named in a text."""
    names: set[str] = set()
    for node in _run_at_runtime(ast.parse(text)):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:  # ruff allows no relative import
            names.add(node.module)
            names.update(f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            names.update(_modules_of_package(node.value))
    return frozenset(names)


def _run_at_runtime(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield all nodes but those of `if TYPE_CHECKING:`."""
    if isinstance(tree, ast.If) and isinstance(tree.test, ast.Name) and tree.test.id == "TYPE_CHECKING":
        return
    yield tree
    for child in ast.iter_child_nodes(tree):
        yield from _run_at_runtime(child)


def _modules_of_package(text: str) -> Iterator[str]:
    if "." not in text or not all(part.isidentifier() for part in text.split(".")):
        return
    path = _file_of(text)
    if path is not None and path.name == "__init__.py":
        yield from (f"{text}.{each.stem}" for each in path.parent.glob("*.py") if each != path)


@lru_cache(maxsize=4096)
def _file_of(name: str) -> Path | None:
    """Return the file of a module of the program; None for anything else."""
    top, *rest = name.split(".")
    if top not in PACKAGES:
        return None
    path = _folder_of(top).joinpath(*rest)
    for file in (path / "__init__.py", path.with_suffix(".py")):
        if file.is_file():
            return file
    return None


@lru_cache
def _folder_of(package: str) -> Path:
    spec = find_spec(package)
    assert spec is not None
    assert spec.origin is not None
    return Path(spec.origin).parent
