"""What the service's own user, a stranger to this machine, can get at from within the unit."""

import os
import stat
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from shlex import quote

from kurt2rt.service.systemd.installation import required_paths

_HOMES = (Path("/home"), Path("/root"), Path("/run/user"))
_OF_ITS_OWN = (Path("/tmp"), Path("/var/tmp"), Path("/dev"))  # PrivateTmp and PrivateDevices
_ELSEWHERE = "in a virtual environment in /opt/kurt2rt, for instance"


@dataclass(frozen=True, slots=True)
class RequiredAccess:
    """What the settings name beside this installation and the unit's own folder."""

    files: tuple[Path, ...] = ()
    """That it reads; absolute."""
    folders: tuple[Path, ...] = ()
    """That it writes; absolute, and there later perhaps, when their disk is."""


def needs_home_access() -> bool:
    """Whether the unit lets its program see homes, for this installation is in one."""
    return any(_is_within(path, _HOMES) for path in required_paths())


def private_paths(wanted: RequiredAccess) -> tuple[str, ...]:
    """Why the service's own user could not start, a line for each reason with what to do; empty when he can."""
    installation = (
        _unreadable(path, f"install kurt2rt where everybody may read, {_ELSEWHERE}") for path in required_paths()
    )
    files = (_unreadable(path, _to_copy(path)) or _hidden(path, _to_copy(path)) for path in wanted.files)
    folders = (_hidden(path, "name a folder elsewhere") or _impassable(path) for path in wanted.folders)
    return tuple(dict.fromkeys(line for line in (*installation, *files, *folders) if line))


def paths_to_chown(user: str, wanted: RequiredAccess) -> tuple[str, ...]:
    """Folders that are there and that `user`, who may not be there yet, may not write; a line each, with what to do."""
    return tuple(
        f"{folder}: belongs to {_owner(folder)}; say: sudo chown {user}: {quote(str(folder))}"
        for folder in wanted.folders
        if folder.is_dir() and _owner(folder) != user and not folder.stat().st_mode & stat.S_IWOTH
    )


def _hidden(path: Path, to_do: str) -> str:
    hides = _OF_ITS_OWN if needs_home_access() else (*_HOMES, *_OF_ITS_OWN)
    for folder in hides:
        if _is_within(path, (folder,)):
            return f"{path}: the service does not see what is in {folder}; {to_do}"
    return ""


def _unreadable(path: Path, to_do: str) -> str:
    for start in _both(path):
        for place in (start, *start.parents):
            wanted = stat.S_IXOTH if place.is_dir() else stat.S_IROTH
            if place.exists() and not place.stat().st_mode & wanted:
                return f"{path}: the service's own user may not read it, for {place} is closed to others; {to_do}"
    return ""


def _impassable(folder: Path) -> str:
    for start in _both(folder):
        for place in start.parents:
            if place.exists() and not place.stat().st_mode & stat.S_IXOTH:
                to_do = f"name a folder elsewhere, or say: sudo chmod o+x {quote(str(place))}"
                return f"{folder}: the service's own user cannot get there, for {place} is closed to others; {to_do}"
    return ""


def _to_copy(path: Path) -> str:
    there = Path("/etc/kurt2rt") / path.name
    return f"say: sudo install -D -m 644 {quote(str(path))} {quote(str(there))}, and name that one"


def _owner(path: Path) -> str:
    try:
        return path.owner()
    except KeyError:  # nobody of this machine
        return str(path.stat().st_uid)


def _is_within(path: Path, folders: Iterable[Path]) -> bool:
    return any(place.is_relative_to(folder) for place in _both(path) for folder in folders)


def _both(path: Path) -> tuple[Path, Path]:
    """Where it is said to be, and where it is behind all links."""
    return path.absolute(), Path(os.path.realpath(path))
