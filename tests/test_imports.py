"""Rooms import in one direction: the table below says which room may import which; no circle between their folders."""

import ast
import sys
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

import networkx as nx
import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("config", "hal", "behaviors", "simbridge", "kurt2rt")
LOW = "config hal simbridge.contracts"
"""Rooms below the robot's program: settings and errors, hardware, and the contracts of a simulation."""
ROOMS: dict[str, frozenset[str]] = {
    room: frozenset(allowed.split())
    for room, allowed in {
        "config": "",
        "hal": "config",
        "behaviors": f"{LOW}",
        "simbridge": "config hal",
        "simbridge.contracts": "config hal",
        "simbridge.batch": "* behaviors simbridge",
        "kurt2rt": "config.errors",
        "kurt2rt.platform": "",
        "kurt2rt.ros": "config hal",
        "kurt2rt.robots": "config hal behaviors simbridge kurt2rt.platform kurt2rt.ros",
        "kurt2rt.core": f"{LOW} behaviors kurt2rt.platform",
        "kurt2rt.knowledge": f"{LOW} behaviors kurt2rt.platform kurt2rt.core",
        "kurt2rt.runtime": f"{LOW} behaviors kurt2rt.platform kurt2rt.core kurt2rt.knowledge",
        "kurt2rt.runs": f"{LOW} kurt2rt.platform kurt2rt.core kurt2rt.knowledge kurt2rt.runtime",
        "kurt2rt.channel": f"{LOW} kurt2rt.platform kurt2rt.core kurt2rt.knowledge kurt2rt.runtime"
        " kurt2rt.runs.explain",
        "kurt2rt.channel.protocol": f"{LOW} kurt2rt.core kurt2rt.platform kurt2rt.runs.explain.facts",
        "kurt2rt.teacher": f"{LOW} behaviors kurt2rt.platform kurt2rt.core kurt2rt.runs.explain"
        " kurt2rt.channel.protocol kurt2rt.channel.security",
        "kurt2rt.teacher.ros": "* kurt2rt.ros kurt2rt.teacher",
        "kurt2rt.service": f"{LOW} behaviors kurt2rt.platform kurt2rt.core kurt2rt.knowledge kurt2rt.runtime"
        " kurt2rt.runs kurt2rt.channel",
        "kurt2rt.experiments": f"{LOW} behaviors kurt2rt.platform kurt2rt.core kurt2rt.knowledge kurt2rt.runtime"
        " kurt2rt.teacher.scripted",
        "kurt2rt.gym": "config hal behaviors simbridge kurt2rt.platform kurt2rt.core kurt2rt.knowledge kurt2rt.runtime"
        " kurt2rt.experiments.lockstep",
        "kurt2rt.library": "config hal simbridge kurt2rt.platform kurt2rt.core kurt2rt.knowledge kurt2rt.runtime"
        " kurt2rt.runs kurt2rt.experiments.lockstep",
        "kurt2rt.checks": f"{LOW} behaviors kurt2rt.platform kurt2rt.core kurt2rt.knowledge kurt2rt.runtime"
        " kurt2rt.runs kurt2rt.channel kurt2rt.teacher kurt2rt.service kurt2rt.experiments",
        "kurt2rt.checks.doctor": "config hal kurt2rt.platform",
        "kurt2rt.checks.commission": "config hal kurt2rt.platform",
        "kurt2rt.cli": "config hal behaviors simbridge kurt2rt",
    }.items()
}
"""Allowed imports of each room besides its own modules; a folder within a room may have a row of its own.

`*` stands for what the room around it may import.
"""
CORE_NEVER_IMPORTS = {"time", "asyncio", "anyio", "threading", "socket", "sqlite3", "os"}
LAYERS_OF_CORE = (
    {"numerics", "outcome", "lesson_speed", "progress", "message_fields", "settings_fields"},
    {"rla", "perception"},
    {"decision", "outcome_text", "event_store"},
    {"basic", "mid"},
    {"learner"},
    {"planning", "expectations", "critic"},
    {"reinforcement"},
    {"task_settings", "phase_settings", "teacher_settings"},
    {"teaching"},
    {"layer_stack", "task_robot", "tick_record"},
    {"tick", "tick_parts", "tick_steps", "progress_meter"},
)
"""Folders and files of core, low to high: each imports only lower ones and itself."""
GUARDS = ("hal/guard.py", "hal/watchdog.py")


def is_below(name: str, room: str) -> bool:
    return name == room or name.startswith(room + ".")


def modules_imported(source: str, package: str) -> Iterator[str]:
    """Full names of imported modules and members, wherever they stand; `package` is where relative imports start."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield from imported_by(node, package)


def imported_by(node: ast.Import | ast.ImportFrom, package: str) -> Iterator[str]:
    """Return the full names that one statement imports."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    else:
        start = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
        module = ".".join([*start, *([node.module] if node.module else [])])
        yield from (f"{module}.{alias.name}" for alias in node.names)


def module_name(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


@lru_cache(maxsize=1)
def modules() -> dict[str, Path]:
    return {module_name(path): path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))}


def module_of(name: str) -> str:
    """Return the module that an imported name is, or stands in."""
    while name not in modules() and "." in name:
        name = name.rpartition(".")[0]
    return name


@lru_cache(maxsize=1)
def arrows() -> tuple[tuple[str, str], ...]:
    """Return (importing module, imported module) for all imports between modules of this project."""
    found = set()
    for name, path in modules().items():
        package = name if path.name == "__init__.py" else name.rpartition(".")[0]
        for imported in modules_imported(path.read_text(encoding="utf-8"), package):
            if imported.split(".")[0] in (*PACKAGES, "tests"):
                found.add((name, module_of(imported)))
    return tuple(sorted(found))


def room_of(name: str) -> str:
    """Return the innermost row of the table that holds a module."""
    return max((room for room in ROOMS if is_below(name, room) and room != "kurt2rt"), key=len, default="kurt2rt")


def allowed_in(room: str) -> frozenset[str]:
    allowed = ROOMS[room]
    return allowed | allowed_in(room_of(room.rpartition(".")[0])) if "*" in allowed else allowed


def test_rooms_each_package_of_kurt2rt_is_listed() -> None:
    found = {name for name in modules() if name.count(".") == 1 and name.startswith("kurt2rt.")}
    assert found == {room for room in ROOMS if room.count(".") == 1 and room.startswith("kurt2rt.")}


@pytest.mark.parametrize("room", ROOMS)
def test_rooms_imports_stay_within_the_table(room: str) -> None:
    allowed = allowed_in(room)
    wrong = [
        f"{name} imports {imported}"
        for name, imported in arrows()
        if room_of(name) == room
        and not is_below(imported, room)
        and not any(is_below(imported, each) for each in allowed)
        and not (imported in ("kurt2rt", room.rpartition(".")[0]) and imported != room)
    ]
    assert not wrong, "; ".join(wrong)


def unit_of(name: str) -> str:
    """Return the sub-folder of a room that holds a module, or the module itself where it lies loose in the room."""
    depth = 3 if name.startswith("kurt2rt.") else 2
    return ".".join(name.split(".")[:depth])


def test_rooms_no_circle_between_folders() -> None:
    graph: nx.DiGraph[str] = nx.DiGraph()
    for name, imported in arrows():
        if unit_of(name) != unit_of(imported) and not is_below(name, imported):
            graph.add_edge(unit_of(name), unit_of(imported))
    circles = [sorted(each) for each in nx.strongly_connected_components(graph) if len(each) > 1]
    assert not circles


def test_core_imports_nothing_that_waits_or_writes() -> None:
    wrong = [
        f"{name} imports {imported}"
        for name, path in modules().items()
        if is_below(name, "kurt2rt.core")
        for imported in modules_imported(path.read_text(encoding="utf-8"), name)
        if imported.split(".")[0] in CORE_NEVER_IMPORTS
    ]
    assert not wrong, "; ".join(wrong)


def test_core_folders_import_lower_folders() -> None:
    height = {part: level for level, parts in enumerate(LAYERS_OF_CORE) for part in parts}
    inside = [
        (name, name.split(".")[2], imported.split(".")[2])
        for name, imported in arrows()
        if is_below(name, "kurt2rt.core") and imported.startswith("kurt2rt.core.") and name != "kurt2rt.core"
    ]
    wrong = [f"{name} imports {there}" for name, here, there in inside if height[here] < height[there]]
    assert not wrong, "; ".join(wrong)


@pytest.mark.parametrize(
    ("package", "needed"),
    [
        ("config", {"config", "yaml", "pydantic", "pydantic_core"}),
        ("simbridge.contracts", {"config", "hal", "simbridge", "numpy", "matplotlib"}),  # no simulator
    ],
)
def test_a_package_needs_nothing_but(package: str, needed: set[str]) -> None:
    for name, path in modules().items():
        if is_below(name, package):
            roots = {each.split(".")[0] for each in modules_imported(path.read_text(encoding="utf-8"), name)}
            assert not roots - sys.stdlib_module_names - needed


@pytest.mark.parametrize("guard", GUARDS)
def test_guards_import_hal_and_the_standard_library_alone(guard: str) -> None:
    roots = {each.split(".")[0] for each in modules_imported((ROOT / guard).read_text(encoding="utf-8"), "hal")}
    assert not roots - sys.stdlib_module_names - {"hal"}


def imported_at_the_top(name: str) -> Iterator[str]:
    for node in ast.parse(modules()[name].read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield from imported_by(node, name)


def test_robot_program_loads_no_matplotlib() -> None:
    reached, waiting = set[str](), ["kurt2rt.service.serve", "kurt2rt.service.open_robot"]
    while waiting:
        name = waiting.pop()
        reached.add(name)
        for imported in imported_at_the_top(name):
            assert not is_below(imported, "matplotlib"), name
            if module_of(imported) in modules() and module_of(imported) not in reached:
                waiting.append(module_of(imported))
    assert "kurt2rt.core.tick" in reached


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("import kurt2rt.clock", "kurt2rt.clock"),
        ("def late():\n    from simbridge import world", "simbridge.world"),
        ("from . import bus", "hal.inner.bus"),
        ("from ..guard import Guard", "hal.guard.Guard"),
    ],
)
def test_modules_imported_finds_each_form(source: str, found: str) -> None:
    assert list(modules_imported(source, "hal.inner")) == [found]
