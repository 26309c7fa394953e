"""Worlds of plug-ins: a file, or a function that makes one."""

from pathlib import Path

import pytest

from config.settings import SettingsError
from simbridge.worlds.world_loading import load_world
from tests.plugin_packages import install
from tests.simbridge.worlds.test_worlds import PLAIN, written

MODULE = f"""
from pathlib import Path

from simbridge.worlds.world_settings import WorldSettings

FILE = Path(__file__).with_name("plain.yaml")
GONE = "/no/such/plain.yaml"
TEN = 10


def plain():
    return {PLAIN!r}


def settings():
    return WorldSettings.model_validate(plain(), strict=False)


def broken():
    return 1 / 0


def listed():
    return [plain()]


def walled():
    return plain() | {{"start_poses": [{{"x_m": 0.1, "y_m": 0.1, "heading_deg": 0.0}}]}}


def misspelt():
    return plain() | {{"wals": []}}


def odd():
    return plain() | {{"name": {{1}}}}
"""


def test_world_of_a_plugin_by_entry_point_and_module_name(plugin_folder: Path) -> None:
    (plugin_folder / "worlds_a.py").write_text(MODULE)
    plain = load_world(written(plugin_folder, {}))
    install(plugin_folder, "ours", {"worlds": {"hall": "worlds_a:plain"}})
    for name in ("hall", "worlds_a:plain", "worlds_a:settings", "worlds_a:FILE"):
        assert load_world(name) == plain


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("GONE", "^worlds_b:GONE: its plug-in names the file /no/such/plain.yaml, which is not there"),
        ("TEN", "^world worlds_b:TEN: worlds_b:TEN is a int, allowed is the path of a YAML file, or a function"),
        ("broken", "^world worlds_b:broken: its function raised ZeroDivisionError: division by zero; mend"),
        ("listed", "returned a list, allowed are WorldSettings or a dict"),
        ("walled", "^worlds_b:walled: start_poses.0: the robot is .* m from a wall"),
        ("misspelt", "^world worlds_b:misspelt: wals: no such key; allowed here: name, "),
        ("odd", "holds what no YAML file can hold: .* set "),
        ("hal", "worlds_b.py has no 'hal'"),
    ],
)
def test_unusable_world_of_a_plugin_says_why(name: str, told: str, plugin_folder: Path) -> None:
    (plugin_folder / "worlds_b.py").write_text(MODULE)
    with pytest.raises(SettingsError, match=told):
        load_world(f"worlds_b:{name}")


def test_unknown_world_lists_those_of_plugins(plugin_folder: Path) -> None:
    install(plugin_folder, "ours", {"worlds": {"hall": "worlds_c:plain"}})
    with pytest.raises(SettingsError, match=r"^hull: .* manhattan, .*; or hall, module:NAME, rooms-N"):
        load_world("hull")
