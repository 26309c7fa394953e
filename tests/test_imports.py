"""Packages import in one direction: config <- hal <- behaviors <- kurt2rt, and config, hal <- simbridge."""

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = {"config", "hal", "behaviors", "kurt2rt", "simbridge"}
MAY_IMPORT = {
    "config": set[str](),
    "hal": {"config"},
    "behaviors": {"config", "hal"},
    "simbridge": {"config", "hal"},
    "kurt2rt": {"config", "hal", "behaviors"},
}
GUARDS = ("hal/guard.py", "hal/watchdog.py")


def modules_imported(source: str, package: str) -> Iterator[str]:
    """Full names of the modules that code imports, wherever in the file; `package` is where relative ones start."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            start = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            yield ".".join([*start, *([node.module] if node.module else [])])


def roots_imported(path: Path) -> set[str]:
    package = ".".join(path.relative_to(ROOT).parent.parts)
    return {name.split(".")[0] for name in modules_imported(path.read_text(encoding="utf-8"), package)}


def may_know_the_simulator(path: Path) -> bool:
    """The composition root and the command line alone know both the runtime and the simulator."""
    parts = path.relative_to(ROOT).parts
    roots = ("app.py", "simulated.py", "simulated_ground.py")
    return (parts[0] == "kurt2rt" and parts[1:] in [(root,) for root in roots]) or parts[:2] == ("kurt2rt", "cli")


@pytest.mark.parametrize("package", sorted(PACKAGES))
def test_a_package_imports_only_what_stands_below_it(package: str) -> None:
    for path in sorted((ROOT / package).rglob("*.py")):
        allowed = {package} | MAY_IMPORT[package] | ({"simbridge"} if may_know_the_simulator(path) else set())
        others = (PACKAGES | {"tests"}) - allowed
        if not any(name in path.read_text(encoding="utf-8") for name in others):
            continue  # what a file does not mention it does not import; the others are worth the parsing
        forbidden = roots_imported(path) & others
        assert not forbidden, f"{path.relative_to(ROOT)} imports {sorted(forbidden)}, allowed are {sorted(allowed)}"


def test_config_needs_nothing_but_the_standard_library() -> None:
    for path in (ROOT / "config").rglob("*.py"):
        foreign = roots_imported(path) - sys.stdlib_module_names - {"config"}
        assert not foreign, f"{path.relative_to(ROOT)} imports {sorted(foreign)}"


@pytest.mark.parametrize("guard", GUARDS)
def test_the_guards_need_nothing_but_hal_and_the_standard_library(guard: str) -> None:
    foreign = roots_imported(ROOT / guard) - sys.stdlib_module_names - {"hal"}
    assert not foreign, f"{guard} imports {sorted(foreign)}"


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("import kurt2rt.clock", "kurt2rt.clock"),
        ("def late():\n    from simbridge import world", "simbridge"),
        ("from . import bus", "hal.inner"),
        ("from ..guard import Guard", "hal.guard"),
    ],
)
def test_the_search_would_find_it(source: str, found: str) -> None:
    assert list(modules_imported(source, "hal.inner")) == [found]
