"""It cannot be overlooked: CONTROL leaves through the guard alone, and python-can's bus stays inside hal.bus."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("config", "hal", "behaviors", "kurt2rt", "simbridge")
RAW_BUS = {"Bus", "BusABC", "ThreadSafeBus", "VirtualBus", "SocketcanBus", "interface", "interfaces"}
KINDS_OF_BUS = {"hal/bus.py", "hal/in_process_bus.py", "hal/python_can.py", "hal/shared_bus.py", "hal/socketcan_bus.py"}
WAYS_OUT = {
    # Ends that reach beyond this process are opened by hal.bus alone; a simulation may build upon those within it.
    "SharedBus": {"hal/bus.py", "hal/python_can.py"},
    # The plug-in is for python-can's own tools: no part of the project may come to the bus through it.
    "python_can": set(),
    "SocketCanBus": {"hal/bus.py"},
    "SocketcanBus": {"hal/socketcan_bus.py"},
    "CAN_RAW": {"kurt2rt/checks/doctor/can_bus.py"},  # which closes it at once
    "CAN_BCM": set(),
}
INSIDES = {"_can_interface", "_open_can_interface"}
ALLOWED = {
    "control_port": {"hal/bus.py", "hal/can_wheel_port.py"},
    "encode_control": {"hal/control.py"},
    "encode_brake": {"hal/control.py", "hal/can_wheel_port.py"},
    "control_frame": {"hal/control.py", "hal/can_wheel_port.py"},
    # Each driver hands its port to its guard, and keeps none.
    "CanWheelPort": {"hal/kurt2.py"},
    "LinkPort": {"hal/linked_robot.py"},
}
_WORDS = "|".join({*WAYS_OUT, *INSIDES, *ALLOWED})
WORTH_PARSING = re.compile(rf"{_WORDS}|\bimport\b.*\bcan\b|\bfrom can\b|\bcan\.|[\"']can[\"']")
"""`can` is a word of English, too."""


def names_in(source: str) -> Iterator[str]:
    """Every name that code mentions: variables, attributes, imports, and strings that getattr could use."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Attribute):
            yield node.attr
        elif isinstance(node, ast.alias):
            yield from node.name.split(".")
        elif isinstance(node, ast.ImportFrom):
            yield from (node.module or "").split(".")
        elif isinstance(node, ast.FunctionDef):
            yield node.name
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


@cache
def names_by_file() -> dict[str, set[str]]:
    """Return the names in each file that may hold one of the forbidden names."""
    files = (path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py")))
    texts = ((path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8")) for path in files)
    return {name: set(names_in(text)) for name, text in texts if WORTH_PARSING.search(text)}


def mentions(names: set[str]) -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    for file, mentioned in names_by_file().items():
        for name in names & mentioned:
            found.setdefault(name, set()).add(file)
    return found


def test_only_the_guard_makes_and_sends_control() -> None:
    assert mentions(set(ALLOWED)) == ALLOWED, (
        "CONTROL is made or sent outside the guard; ask Robot.drive or Guard.drive instead"
    )


def test_the_raw_bus_stays_inside_its_module() -> None:
    assert mentions(INSIDES) == {name: {"hal/bus.py"} for name in INSIDES}
    for file in mentions({"can"})["can"] - KINDS_OF_BUS:
        used = RAW_BUS & names_by_file()[file]
        assert not used, f"{file} touches {sorted(used)} of python-can's bus; use hal.bus.CanBus"


def test_no_other_way_leads_out_of_this_process() -> None:
    found = mentions(set(WAYS_OUT))
    assert {name: found.get(name, set()) for name in WAYS_OUT} == WAYS_OUT


@pytest.mark.parametrize(
    ("source", "name"),
    [
        ("bus.control_port()", "control_port"),
        ("from hal.control import encode_brake as harmless", "encode_brake"),
        ("import hal.control as c\nc.encode_control", "encode_control"),
        ("getattr(bus, 'control_port')()", "control_port"),
        ("import can.interfaces.virtual", "interfaces"),
        ("from can.interface import Bus", "Bus"),
        ("from hal.shared_bus import SharedBus as Way", "SharedBus"),
        ("socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)", "CAN_RAW"),
    ],
)
def test_the_search_would_find_it(source: str, name: str) -> None:
    assert name in set(names_in(source))
    assert WORTH_PARSING.search(source)
