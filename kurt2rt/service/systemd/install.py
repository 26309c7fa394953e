"""Installation and removal of the unit."""

import pwd
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from kurt2rt.platform.durable_files import write_durably
from kurt2rt.service.systemd.unit import MARK, USER, Unit, require_name
from kurt2rt.service.systemd.unit_error import UnitCode, UnitError

CommandRunner = Callable[[Sequence[str]], None]
"""Runs one of systemd's commands. Raises UnitError."""


@dataclass(frozen=True, slots=True)
class InstallPaths:
    """Folders of systemd into which a unit's files are installed; tests give others."""

    units: Path = Path("/etc/systemd/system")
    users: Path = Path("/etc/sysusers.d")
    others: tuple[Path, ...] = tuple(
        map(Path, ("/run/systemd/system", "/usr/local/lib/systemd/system", "/usr/lib/systemd/system"))
    )
    """Folders of other programs' units, which our unit must not hide."""

    def files(self, name: str) -> tuple[Path, Path]:
        """Return the paths of a unit's files: the service, and the definition of its user."""
        return self.units / f"{name}.service", self.users / f"{name}.conf"


def run_command(command: Sequence[str]) -> None:
    """Run a command of systemd. Raises UnitError if it fails or is missing."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        raise UnitError(UnitCode.NO_COMMAND, command=command[0]) from error
    if done.returncode:
        says = " ".join(done.stderr.split()) or f"exit code {done.returncode}"
        raise UnitError(UnitCode.COMMAND_FAILED, where=" ".join(command), says=says)


def require_free(name: str, places: InstallPaths | None = None) -> None:
    """Raise UnitError for an invalid name, or one that a unit or a user of another program has."""
    require_name(name)
    places = places or InstallPaths()
    for path in (*places.files(name), *(folder / f"{name}.service" for folder in places.others)):
        if _is_there(path) and not (path.parent in (places.units, places.users) and _is_ours(path)):
            raise UnitError(UnitCode.NAME_TAKEN, where=path)
    try:
        user = pwd.getpwnam(name)
    except KeyError:
        return
    if user.pw_gecos != USER:
        raise UnitError(UnitCode.USER_TAKEN, where=name)


def install(unit: Unit, run: CommandRunner = run_command, places: InstallPaths | None = None) -> tuple[Path, ...]:
    """Write the unit and make its user, without starting it; return the written files.

    Raises UnitError if the name is taken, a file cannot be written, or a command of systemd fails.
    """
    places = places or InstallPaths()
    require_free(unit.name, places)
    files = places.files(unit.name)
    for path, text in zip(files, (unit.service, unit.sysusers), strict=True):
        try:
            write_durably(path, text)
        except OSError as error:
            raise UnitError(UnitCode.NOT_WRITTEN, where=path, error=error) from error
    run(("systemd-sysusers", str(files[1])))
    run(("systemctl", "daemon-reload"))
    return files


def uninstall(name: str, run: CommandRunner = run_command, places: InstallPaths | None = None) -> tuple[Path, ...]:
    """Stop and disable the unit and remove its files; knowledge and user stay. Return the removed files.

    Raises UnitError if there is no such unit of kurt2rt, or a file or a command of systemd fails.
    """
    require_name(name)
    places = places or InstallPaths()
    files = tuple(each for each in places.files(name) if _is_there(each))
    if not files:
        raise UnitError(UnitCode.NO_UNIT, where=places.files(name)[0])
    for path in files:
        if not _is_ours(path):
            raise UnitError(UnitCode.NOT_OURS, where=path)
    run(("systemctl", "disable", "--now", f"{name}.service"))
    for path in files:
        try:
            path.unlink()
        except OSError as error:
            raise UnitError(UnitCode.NOT_REMOVED, where=path, error=error) from error
    run(("systemctl", "daemon-reload"))
    return files


def _is_there(path: Path) -> bool:
    return path.is_symlink() or path.exists()  # a dangling link belongs to another program


def _is_ours(path: Path) -> bool:
    try:
        return not path.is_symlink() and path.read_text(encoding="utf-8", errors="replace").startswith(MARK)
    except OSError as error:
        raise UnitError(UnitCode.NOT_READ, where=path, error=error) from error
