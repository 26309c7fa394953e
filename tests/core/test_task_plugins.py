"""Tasks of plug-ins: the path of a YAML file that a module names."""

from pathlib import Path

import pytest

from hal.settings import SettingsError
from kurt2rt.core.task_settings import load_task
from tests.plugin_packages import install, write_task


def test_task_of_a_plugin_by_entry_point_and_module_name(plugin_folder: Path) -> None:
    path = write_task(plugin_folder, name="strolling")
    (plugin_folder / "tasks_a.py").write_text(f"TASK = {str(path)!r}\nGONE = 'gone.yaml'\nTEN = 10\n")
    install(plugin_folder, "ours", {"tasks": {"strolling": "tasks_a:TASK"}})
    for name in ("strolling", "tasks_a:TASK"):
        assert load_task(name).name == "strolling"
    with pytest.raises(SettingsError, match=r"^tasks_a:GONE: its plug-in names the file gone\.yaml, which is not"):
        load_task("tasks_a:GONE")
    with pytest.raises(SettingsError, match=r"is a int, allowed is the path of a YAML file"):
        load_task("tasks_a:TEN")
    with pytest.raises(SettingsError, match=r"in tasks; give module:NAME, .*, strolling; did you mean strolling"):
        load_task("strollin")
