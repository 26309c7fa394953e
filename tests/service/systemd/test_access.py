"""Access of the service's user: obstacles are found before the unit is installed."""

import getpass
import shutil
from pathlib import Path

import pytest
import yaml

from config import CONFIG_DIR
from kurt2rt.service.systemd import access
from kurt2rt.service.systemd.access import (
    AccessCode,
    AccessFinding,
    RequiredAccess,
    access_text,
    paths_to_chown,
    private_paths,
)
from kurt2rt.service.systemd.installation import start_command
from kurt2rt.service.systemd.unit_error import UnitCode, UnitError
from tests import plugin_parts
from tests.cli.helpers import CommandLine


@pytest.fixture(autouse=True)
def _well_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Set the required paths to /usr, which all users may read; this copy may be in a home."""
    monkeypatch.setattr(access, "required_paths", lambda: (Path("/usr"),))


def settings_in(folder: Path, **changes: object) -> Path:
    settings = yaml.safe_load((CONFIG_DIR / "runtime" / "default.yaml").read_text(encoding="utf-8"))
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump({**settings, **changes}), encoding="utf-8")
    return path


def test_nothing_is_in_the_way_of_the_shipped_settings() -> None:
    assert private_paths(RequiredAccess((Path("/usr"),), (Path("/mnt/a disk that comes later"),))) == ()


def test_a_folder_of_somebody_else_is_to_be_handed_over(tmp_path: Path) -> None:
    tmp_path.chmod(0o755)
    assert paths_to_chown("kurt2rt", RequiredAccess((), (tmp_path,))) == (
        AccessFinding(AccessCode.FOLDER_OF_ANOTHER, tmp_path, owner=getpass.getuser(), user="kurt2rt"),
    )
    assert paths_to_chown(tmp_path.owner(), RequiredAccess((), (tmp_path,))) == ()
    assert paths_to_chown("kurt2rt", RequiredAccess((), (tmp_path / "comes later",))) == ()


def test_install_refuses_what_could_never_start(kurt2rt: CommandLine, tmp_path: Path) -> None:
    mine = settings_in(tmp_path)
    mine.chmod(0o600)
    finding = AccessFinding(AccessCode.FILE_UNREADABLE, mine, mine)
    refused = kurt2rt.refused("service", "install", "--name", "nosuch-robot", "--settings", mine)
    assert refused == f"kurt2rt: {access_text(finding)}"


def test_a_robot_beside_the_terminal_is_not_beside_the_service(
    kurt2rt: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    text = (CONFIG_DIR / "robots" / "kurt2.yaml").read_text(encoding="utf-8")
    (tmp_path / "my-kurt2.yaml").write_text(text, encoding="utf-8")
    mine = settings_in(tmp_path, robot="my-kurt2.yaml")
    said = kurt2rt.refused("service", "show", "--settings", mine)
    error = UnitError(UnitCode.RELATIVE_PATH, where="robot", given="my-kurt2.yaml", state="/var/lib/kurt2rt")
    assert str(error) in said


def test_task_of_a_module_of_this_folder_is_refused(kurt2rt: CommandLine, plugin_folder: Path) -> None:
    text = (CONFIG_DIR / "tasks" / "fleeing.yaml").read_text(encoding="utf-8")
    (plugin_folder / "task.yaml").write_text(text, encoding="utf-8")
    (plugin_folder / "my_tasks.py").write_text(
        "from pathlib import Path\nFLEE = Path(__file__).with_name('task.yaml')\n"
    )
    settings = settings_in(plugin_folder, task="my_tasks:FLEE")
    for command in ("show", "check", "install"):
        said = kurt2rt.refused("service", command, "--name", "nosuch-robot", "--settings", settings)
        assert f"would not find my_tasks: it is in {plugin_folder / 'my_tasks.py'}" in said


def test_module_that_is_installed_is_found_by_a_service(
    kurt2rt: CommandLine, plugin_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    site = plugin_folder / "site"
    site.mkdir()
    monkeypatch.syspath_prepend(str(site))
    shutil.copy(Path(plugin_parts.__file__), site / "my_parts.py")
    task = yaml.safe_load((CONFIG_DIR / "tasks" / "fleeing.yaml").read_text(encoding="utf-8"))
    (site / "task.yaml").write_text(yaml.safe_dump(task | {"policy": {"kind": "my_parts:Turning"}}))
    settings = settings_in(site, task=str(site / "task.yaml"))
    assert "ExecStart=" in kurt2rt("service", "show", "--settings", settings).out


def test_show_prints_the_unit_for_this_installation(kurt2rt: CommandLine) -> None:
    said = kurt2rt("service", "show", "--bus", "can1", "--page")
    assert f"ExecStart={start_command()[0]} " in said.out
    assert " run --service --bus can1 --settings default --page\n" in said.out
    assert "Traceback" not in kurt2rt.refused("service", "show", "--settings", "task.yaml")
