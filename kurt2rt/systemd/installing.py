"""The unit is put in its place and taken away again."""

import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

from kurt2rt.durable import write_durably
from kurt2rt.systemd.error import UnitError
from kurt2rt.systemd.unit import Unit

UNITS, USERS = Path("/etc/systemd/system"), Path("/etc/sysusers.d")

Do = Callable[[Sequence[str]], None]
"""Runs one of systemd's commands. Raises UnitError."""


def do(command: Sequence[str]) -> None:
    """Run a command of systemd. Raises UnitError when it fails or is not there."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        raise UnitError(f"{command[0]} is not on this machine; the unit needs systemd") from error
    if done.returncode:
        raise UnitError(f"{' '.join(command)}: {' '.join(done.stderr.split()) or f'exit code {done.returncode}'}")


def install(unit: Unit, run: Do = do, units: Path = UNITS, users: Path = USERS) -> tuple[Path, ...]:
    """Write the unit and make its user; starts nothing. Returns the files. Raises UnitError."""
    files = _files(unit.name, units, users)
    for path, text in zip(files, (unit.service, unit.sysusers), strict=True):
        try:
            write_durably(path, text)
        except OSError as error:
            raise UnitError(f"{path}: cannot be written ({error}); say it with sudo") from error
    run(("systemd-sysusers", str(files[1])))
    run(("systemctl", "daemon-reload"))
    return files


def uninstall(name: str, run: Do = do, units: Path = UNITS, users: Path = USERS) -> tuple[Path, ...]:
    """End and disable the unit and remove its files; what was taught and its user stay. Raises UnitError."""
    files = tuple(each for each in _files(name, units, users) if each.exists())
    if not files:
        raise UnitError(f"{units / f'{name}.service'}: there is no such unit; kurt2rt service install makes one")
    run(("systemctl", "disable", "--now", f"{name}.service"))
    for path in files:
        try:
            path.unlink()
        except OSError as error:
            raise UnitError(f"{path}: cannot be removed ({error}); say it with sudo") from error
    run(("systemctl", "daemon-reload"))
    return files


def _files(name: str, units: Path, users: Path) -> tuple[Path, Path]:
    return units / f"{name}.service", users / f"{name}.conf"
