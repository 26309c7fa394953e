"""The unit is put in its place and taken away; what is another program's is not touched."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from kurt2rt.service.systemd.install import InstallPaths, install, require_free, uninstall
from kurt2rt.service.systemd.installation import start_command
from kurt2rt.service.systemd.unit import Unit, build_unit
from kurt2rt.service.systemd.unit_error import UnitCode, UnitError

SSH = "[Unit]\nDescription=OpenBSD Secure Shell server\n"


class Machine:
    """Its folders of units, and what its service manager was told."""

    def __init__(self, folder: Path) -> None:
        self.places = InstallPaths(folder / "system", folder / "sysusers.d", (folder / "lib",))
        for each in (self.places.units, self.places.users, *self.places.others):
            each.mkdir()
        self.done: list[Sequence[str]] = []

    def install(self, name: str = "kurt2rt") -> tuple[Path, ...]:
        return install(unit(name), self.done.append, self.places)

    def uninstall(self, name: str = "kurt2rt") -> tuple[Path, ...]:
        return uninstall(name, self.done.append, self.places)

    @property
    def files(self) -> list[Path]:
        return [*self.places.units.iterdir(), *self.places.users.iterdir()]


@pytest.fixture
def machine(tmp_path: Path) -> Machine:
    return Machine(tmp_path)


def unit(name: str = "kurt2rt") -> Unit:
    return build_unit(name, "can0", (*start_command(), "run", "--service"))


def test_it_is_installed_and_taken_away_again(machine: Machine) -> None:
    service, sysusers = machine.install()
    assert service.read_text(encoding="utf-8") == unit().service
    assert 'u kurt2rt - "KURT2 robot" /var/lib/kurt2rt' in sysusers.read_text(encoding="utf-8")
    assert machine.done == [("systemd-sysusers", str(sysusers)), ("systemctl", "daemon-reload")]
    machine.done.clear()
    assert machine.uninstall() == (service, sysusers)
    assert machine.done == [("systemctl", "disable", "--now", "kurt2rt.service"), ("systemctl", "daemon-reload")]
    assert machine.files == []
    with pytest.raises(UnitError) as refused:
        machine.uninstall()
    assert refused.value.code is UnitCode.NO_UNIT


@pytest.mark.parametrize("folder", ["system", "sysusers.d"])
def test_install_over_a_foreign_unit_is_refused(folder: str, machine: Machine, tmp_path: Path) -> None:
    others = tmp_path / folder / ("robotd.service" if folder == "system" else "robotd.conf")
    others.write_text(SSH, encoding="utf-8")
    with pytest.raises(UnitError) as refused:
        machine.install("robotd")
    assert refused.value.code is UnitCode.NAME_TAKEN
    with pytest.raises(UnitError) as refused:
        machine.uninstall("robotd")
    assert refused.value.code is UnitCode.NOT_OURS
    assert machine.done == []
    assert machine.files == [others]
    assert others.read_text(encoding="utf-8") == SSH


def test_a_user_of_the_machine_does_not_become_the_robots(machine: Machine) -> None:
    with pytest.raises(UnitError) as refused:
        require_free("daemon", machine.places)
    assert refused.value.code is UnitCode.USER_TAKEN


@pytest.mark.parametrize("name", ["../ssh", "", "SSH"])
def test_uninstall_of_an_invalid_name_is_refused(name: str, machine: Machine) -> None:
    with pytest.raises(UnitError) as refused:
        machine.uninstall(name)
    assert refused.value.code is UnitCode.BAD_NAME
    assert machine.done == []
