"""The unit: what it may do, how it is installed and taken away, and paths that its user cannot use."""

import getpass
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest
import yaml

from config import CONFIG_DIR
from kurt2rt.service.systemd import access
from kurt2rt.service.systemd.access import RequiredAccess, paths_to_chown, require_access, start_command
from kurt2rt.service.systemd.install import InstallPaths, install, require_free, uninstall
from kurt2rt.service.systemd.unit import Unit, build_unit
from kurt2rt.service.systemd.unit_error import UnitCode, UnitError
from tests import plugin_parts
from tests.cli.helpers import CommandLine

SSH = "[Unit]\nDescription=OpenBSD Secure Shell server\n"
TOOL = shutil.which("systemd-analyze")
MOST_EXPOSURE = "2.0"
"""Highest exposure of 10 by `systemd-analyze security`; the unit needs CAN, network and real-time priority."""


def unit(name: str = "kurt2rt", bus: str = "can0") -> Unit:
    return build_unit(name, bus, (*start_command(), "run", "--service"), [Path("/mnt/my disk/kurt")])


def settings_of(text: str) -> list[tuple[str, str]]:
    lines = [line for line in text.splitlines() if "=" in line and not line.startswith("#")]
    return [(key, value) for key, _, value in (line.partition("=") for line in lines)]


def test_unit_comes_back_is_watched_and_may_do_little() -> None:
    settings = settings_of(unit().service)
    said = dict(settings)
    assert said["Type"] == "notify"
    assert float(said["WatchdogSec"]) > 0
    assert (said["Restart"], said["StartLimitIntervalSec"]) == ("always", "0")
    assert (said["User"], said["StateDirectory"], said["WorkingDirectory"]) == ("kurt2rt", "kurt2rt", "%S/kurt2rt")
    assert [value for key, value in settings if "Capabilit" in key] == ["CAP_SYS_NICE", "CAP_SYS_NICE"]
    assert said["ProtectSystem"] == "strict"
    assert said["ReadWritePaths"] == '-"/mnt/my disk/kurt"'  # which may be mounted later


@pytest.mark.skipif(TOOL is None, reason="systemd-analyze is not here; on Debian: apt-get install systemd")
def test_systemd_takes_the_unit_and_finds_it_shut(tmp_path: Path) -> None:
    assert TOOL is not None
    path = tmp_path / "kurt2rt.service"
    path.write_text(unit().service, encoding="utf-8")
    verified = subprocess.run([TOOL, "verify", "--man=no", path], capture_output=True, text=True, check=True)
    assert path.name not in verified.stderr
    threshold = f"--threshold={float(MOST_EXPOSURE) * 10:.0f}"
    subprocess.run([TOOL, "security", "--offline=true", threshold, "--no-pager", path], check=True)


@pytest.mark.parametrize(
    ("name", "bus", "code"),
    [
        *((name, "can0", UnitCode.BAD_NAME) for name in ("", "Robot", "../etc", "a b", "9", "x" * 40)),
        ("kurt2rt", "can0\nExecStartPre=/bin/sh", UnitCode.UNPRINTABLE),
    ],
)
def test_unit_of_words_that_cannot_stand_in_it_is_refused(name: str, bus: str, code: UnitCode) -> None:
    with pytest.raises(UnitError) as refused:
        unit(name, bus)
    assert refused.value.code is code


class Machine:
    """Its folders of units, and what its service manager was told."""

    def __init__(self, folder: Path) -> None:
        self.places = InstallPaths(folder / "system", folder / "sysusers.d", (folder / "lib",))
        for each in (self.places.units, self.places.users, *self.places.others):
            each.mkdir()
        self.done: list[Sequence[str]] = []

    def uninstall(self, name: str = "kurt2rt") -> tuple[Path, ...]:
        return uninstall(name, self.done.append, self.places)

    @property
    def files(self) -> list[Path]:
        return [*self.places.units.iterdir(), *self.places.users.iterdir()]


@pytest.fixture
def machine(tmp_path: Path) -> Machine:
    return Machine(tmp_path)


def test_unit_is_installed_and_taken_away_again(machine: Machine) -> None:
    service, sysusers = install(unit(), machine.done.append, machine.places)
    assert service.read_text(encoding="utf-8") == unit().service
    assert 'u kurt2rt - "KURT2 robot" /var/lib/kurt2rt' in sysusers.read_text(encoding="utf-8")
    assert machine.done == [("systemd-sysusers", str(sysusers)), ("systemctl", "daemon-reload")]
    machine.done.clear()
    assert machine.uninstall() == (service, sysusers)
    assert machine.done == [("systemctl", "disable", "--now", "kurt2rt.service"), ("systemctl", "daemon-reload")]
    assert machine.files == []
    for name, code in (("kurt2rt", UnitCode.NO_UNIT), ("../ssh", UnitCode.BAD_NAME)):
        with pytest.raises(UnitError) as refused:
            machine.uninstall(name)
        assert refused.value.code is code


@pytest.mark.parametrize("file", ["system/robotd.service", "sysusers.d/robotd.conf"])
def test_install_over_a_foreign_unit_is_refused(file: str, machine: Machine, tmp_path: Path) -> None:
    others = tmp_path / file
    others.write_text(SSH, encoding="utf-8")
    with pytest.raises(UnitError) as refused:
        install(unit("robotd"), machine.done.append, machine.places)
    assert refused.value.code is UnitCode.NAME_TAKEN
    with pytest.raises(UnitError) as refused:
        machine.uninstall("robotd")
    assert refused.value.code is UnitCode.NOT_OURS
    assert (machine.done, machine.files, others.read_text(encoding="utf-8")) == ([], [others], SSH)


def test_user_of_the_machine_does_not_become_the_robots(machine: Machine) -> None:
    with pytest.raises(UnitError) as refused:
        require_free("daemon", machine.places)
    assert refused.value.code is UnitCode.USER_TAKEN


@pytest.fixture
def _readable_installation(monkeypatch: pytest.MonkeyPatch) -> None:
    """Set the required paths to /usr, which all users may read; this copy may be in a home."""
    monkeypatch.setattr(access, "required_paths", lambda: (Path("/usr"),))


def settings_in(folder: Path, **changes: object) -> Path:
    settings = yaml.safe_load((CONFIG_DIR / "runtime" / "default.yaml").read_text(encoding="utf-8"))
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump({**settings, **changes}), encoding="utf-8")
    return path


@pytest.mark.usefixtures("_readable_installation")
def test_folder_of_another_user_is_to_be_handed_over(tmp_path: Path) -> None:
    require_access(RequiredAccess((Path("/usr"),), (Path("/mnt/a disk that comes later"),)))
    tmp_path.chmod(0o755)
    (finding,) = paths_to_chown("kurt2rt", RequiredAccess((), (tmp_path, tmp_path / "comes later")))
    assert finding.code is UnitCode.FOLDER_OF_ANOTHER
    assert str(finding) == f"{tmp_path}: belongs to {getpass.getuser()}; say: sudo chown kurt2rt: {tmp_path}"
    assert paths_to_chown(tmp_path.owner(), RequiredAccess((), (tmp_path,))) == ()


@pytest.mark.usefixtures("_readable_installation")
def test_install_refuses_what_could_never_start(kurt2rt: CommandLine, tmp_path: Path) -> None:
    mine = settings_in(tmp_path)
    mine.chmod(0o600)
    refused = kurt2rt.refused("service", "install", "--name", "nosuch-robot", "--settings", mine)
    assert f"{mine}: the service's user cannot read it, because {mine} is closed" in refused
    text = (CONFIG_DIR / "robots" / "kurt2.yaml").read_text(encoding="utf-8")
    (tmp_path / "my-kurt2.yaml").write_text(text, encoding="utf-8")
    said = kurt2rt.refused("service", "show", "--settings", settings_in(tmp_path, robot="my-kurt2.yaml"))
    error = UnitError(UnitCode.RELATIVE_PATH, where="robot", given="my-kurt2.yaml", state="/var/lib/kurt2rt")
    assert str(error) in said


def test_show_prints_the_unit_for_this_installation(
    kurt2rt: CommandLine, plugin_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    site = plugin_folder / "site"
    site.mkdir()
    monkeypatch.syspath_prepend(str(site))
    shutil.copy(Path(plugin_parts.__file__), site / "my_parts.py")  # an installed module is found by a service
    task = yaml.safe_load((CONFIG_DIR / "tasks" / "fleeing.yaml").read_text(encoding="utf-8"))
    (site / "task.yaml").write_text(yaml.safe_dump(task | {"policy": {"kind": "my_parts:Turning"}}))
    settings = settings_in(site, task=str(site / "task.yaml"))
    said = kurt2rt("service", "show", "--bus", "can1", "--page", "--settings", settings)
    assert f"ExecStart={start_command()[0]} " in said.out
    assert f" run --service --bus can1 --settings {settings} --page\n" in said.out
