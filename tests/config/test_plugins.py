"""Plug-ins by entry point and by module:Name, and their errors."""

import sys
from contextlib import suppress
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from config import plugins
from config.plugins import PluginError, PluginKind, UnknownPluginError, loaded_plugins, settings_from_elsewhere
from config.settings import SettingsError
from config.settings_files import TASKS, find_config
from tests.plugin_packages import install

NUMBERS = PluginKind("numbers", "number", "an int", lambda found: isinstance(found, int), lambda: ("one", "seven"))


def refusal(name: str) -> str:
    with pytest.raises(PluginError) as refused:
        NUMBERS.find(name)
    return str(refused.value)


def test_plugin_by_entry_point_is_found_and_names_its_package(plugin_folder: Path) -> None:
    (plugin_folder / "plug_a.py").write_text("NINE = 9\n")
    install(plugin_folder, "nines", {"numbers": {"nine": "plug_a:NINE"}, "letters": {"nu": "plug_a:NU"}})
    assert NUMBERS.find("nine") == 9
    assert [each.name for each in NUMBERS.installed()] == ["nine"]
    assert [(each.name, each.source) for each in loaded_plugins()] == [("nine", "nines 1.0")]


def test_plugin_of_the_current_folder_names_its_file(plugin_folder: Path) -> None:
    (plugin_folder / "plug_b.py").write_text("import plug_c\n\n\nclass Held:\n    NINE = plug_c.NINE\n")
    (plugin_folder / "plug_c.py").write_text("NINE = 9\n")
    assert NUMBERS.find("plug_b:Held.NINE") == 9
    assert [each.source for each in loaded_plugins()] == [str(plugin_folder / "plug_b.py")]
    assert sys.path[-1] == str(plugin_folder)  # for the processes of a study


@pytest.mark.parametrize("name", ["no_such_task", "no/such_task", "school/fleeing"])
def test_name_of_a_task_reads_entry_points_once(
    plugin_folder: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    reads: list[int] = []

    def counted() -> object:
        reads.append(1)
        return entry_points()

    monkeypatch.setattr(plugins, "entry_points", counted)
    install(plugin_folder, "tasks", {"tasks": {"mine": "plug_a:MINE"}})
    for _ in range(2):
        with suppress(SettingsError):
            find_config("tasks", name)
    assert len(reads) == 1
    install(plugin_folder, "more", {"tasks": {"yours": "plug_a:YOURS"}})
    assert [each.name for each in TASKS.installed()] == ["mine", "yours"]
    assert len(reads) == 2


def test_unknown_plugin_lists_all_names_and_the_nearest(plugin_folder: Path) -> None:
    install(plugin_folder, "nines", {"numbers": {"nine": "plug_a:NINE"}})
    assert refusal("sevn") == (
        "number sevn: there is no such number; give module:Name, or one of: one, seven, nine; did you mean seven?"
    )
    for name in ("", "a:b:c", ":NINE", "plug_a:", "../plug_a:NINE", "a b:c"):
        with pytest.raises(UnknownPluginError):
            NUMBERS.find(name)


@pytest.mark.parametrize(
    ("source", "told"),
    [
        ("import no_such_package\n", "plug_d.py, line 1: ModuleNotFoundError: No module named 'no_such_package'"),
        ("\n1 / 0\n", "plug_d.py, line 2: ZeroDivisionError: division by zero"),
        ("def f(:\n", "plug_d.py, line 1: SyntaxError: invalid syntax"),
        ("import sys\nsys.exit('over')\n", "plug_d.py, line 2: SystemExit: over"),
        ("NUMBER = 8\n", "plug_d.py has no 'NINE'"),
        ("NINE = 'nine'\n", "plug_d:NINE is a str, allowed is an int"),
        ("class NINE: ...\n", "plug_d:NINE is the class NINE, allowed is an int"),
    ],
)
def test_unusable_plugin_names_file_and_error(source: str, told: str, plugin_folder: Path) -> None:
    (plugin_folder / "plug_d.py").write_text(source)
    said = refusal("plug_d:NINE")
    assert said.startswith("number plug_d:NINE: ")
    assert told in said
    assert loaded_plugins() == ()


def test_plugin_without_its_module_names_the_folder_searched(plugin_folder: Path) -> None:
    path = [*sys.path]
    assert f"there is no module 'plug_e' on Python's path or in {plugin_folder}; " in refusal("plug_e:NINE")
    assert sys.path == path


def test_two_packages_of_one_name_are_refused_by_that_name(plugin_folder: Path) -> None:
    (plugin_folder / "plug_f.py").write_text("NINE = 9\n")
    for package in ("nines", "others"):
        install(plugin_folder, package, {"numbers": {"nine": "plug_f:NINE"}})
    assert "nines 1.0 and others 1.0 both offer this name; uninstall one" in refusal("nine")
    assert NUMBERS.find("plug_f:NINE") == 9


def test_settings_from_elsewhere_import_only_known_plugins(plugin_folder: Path) -> None:
    (plugin_folder / "plug_g.py").write_text("NINE = 9\nTEN = 10\n")
    install(plugin_folder, "nines", {"numbers": {"nine": "plug_g:NINE"}})
    with settings_from_elsewhere():
        assert "may not import it; install it" in refusal("plug_g:TEN")
        assert "plug_g" not in sys.modules
        assert (NUMBERS.find("nine"), NUMBERS.find("plug_g:NINE")) == (9, 9)
    assert NUMBERS.find("plug_g:TEN") == 10
    with settings_from_elsewhere():  # this process trusts it already
        assert NUMBERS.find("plug_g:TEN") == 10
