"""The unit says what the issue asks of it, and systemd's own tools agree."""

import shutil
import tomllib
from pathlib import Path

import pytest

from config import CONFIG_DIR
from kurt2rt.service.systemd.installation import start_command
from kurt2rt.service.systemd.unit import Unit, build_unit
from kurt2rt.service.systemd.unit_error import UnitCode, UnitError
from kurt2rt.service.systemd.verify import MOST_EXPOSURE, TOOL, verify

needs_systemd = pytest.mark.skipif(
    shutil.which(TOOL) is None, reason="systemd-analyze is not here; on Debian: apt-get install systemd"
)


def unit(**changes: str) -> Unit:
    return build_unit(
        changes.get("name", "kurt2rt"), changes.get("bus", "can0"), (*start_command(), "run", "--service")
    )


def settings_of(text: str) -> list[tuple[str, str]]:
    lines = [line for line in text.splitlines() if "=" in line and not line.startswith("#")]
    return [(key, value) for key, _, value in (line.partition("=") for line in lines)]


def test_it_cannot_stay_dead_and_is_watched() -> None:
    said = dict(settings_of(unit().service))
    assert said["Type"] == "notify"
    assert float(said["WatchdogSec"]) > 0
    assert (said["Restart"], said["StartLimitIntervalSec"]) == ("always", "0")
    assert (said["User"], said["StateDirectory"], said["WorkingDirectory"]) == ("kurt2rt", "kurt2rt", "%S/kurt2rt")


def test_unit_has_only_the_real_time_capability() -> None:
    said = settings_of(unit().service)
    of_capabilities = [value for key, value in said if "Capabilit" in key]
    assert of_capabilities == ["CAP_SYS_NICE", "CAP_SYS_NICE"]
    assert ("ProtectSystem", "strict") in said


def test_unit_may_write_a_folder_that_is_mounted_later() -> None:
    made = build_unit("kurt2rt", "can0", start_command(), [Path("/mnt/my disk/kurt")])
    assert ("ReadWritePaths", '-"/mnt/my disk/kurt"') in settings_of(made.service)


@pytest.mark.parametrize("name", ["", "Robot", "../etc", "a b", "9", "x" * 40])
def test_a_name_that_is_none_is_refused(name: str) -> None:
    with pytest.raises(UnitError) as refused:
        unit(name=name)
    assert refused.value.code is UnitCode.BAD_NAME


def test_a_bus_with_a_line_break_does_not_add_a_line() -> None:
    with pytest.raises(UnitError) as refused:
        unit(bus="can0\nExecStartPre=/bin/sh")
    assert refused.value.code is UnitCode.UNPRINTABLE


@needs_systemd
def test_systemd_takes_it_and_finds_it_shut() -> None:
    found = verify(unit())
    assert found.complaints == ()
    assert found.exposure <= MOST_EXPOSURE
    assert found.passed


@needs_systemd
def test_a_misspelt_setting_is_found() -> None:
    made = unit()
    broken = Unit(made.name, made.service.replace("Restart=always", "Restart=alwys"), made.sysusers)
    found = verify(broken)
    assert any("alwys" in line for line in found.complaints)
    assert not found.passed


def test_it_comes_with_pip() -> None:
    project = tomllib.loads((CONFIG_DIR.parent / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = project["tool"]["setuptools"]["package-data"]["config"]
    packed = {path for pattern in patterns for path in CONFIG_DIR.glob(pattern)}
    assert set((CONFIG_DIR / "service").iterdir()) <= packed
