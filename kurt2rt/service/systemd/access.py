"""File access of the unit's own user."""

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
    """Files and folders of the settings, without this installation and the unit's own folder."""

    files: tuple[Path, ...] = ()
    """Absolute paths that the service reads."""
    folders: tuple[Path, ...] = ()
    """Absolute paths that the service writes; their disk may be mounted later."""


def needs_home_access() -> bool:
    """Return whether the unit needs access to homes, because this installation is in one."""
    return any(_is_within(path, _HOMES) for path in required_paths())


def private_paths(required: RequiredAccess) -> tuple[str, ...]:
    """Return each path that the unit's user cannot reach, in a line with the cure; empty if it can start."""
    installation = (
        _unreadable(path, f"install kurt2rt where everybody may read, {_ELSEWHERE}") for path in required_paths()
    )
    files = (_unreadable(path, _to_copy(path)) or _hidden(path, _to_copy(path)) for path in required.files)
    folders = (_hidden(path, "name a folder elsewhere") or _impassable(path) for path in required.folders)
    return tuple(dict.fromkeys(line for line in (*installation, *files, *folders) if line))


def paths_to_chown(user: str, required: RequiredAccess) -> tuple[str, ...]:
    """Return each existing folder that `user` may not write, in a line with the cure; `user` need not exist yet."""
    return tuple(
        f"{folder}: belongs to {_owner(folder)}; say: sudo chown {user}: {quote(str(folder))}"
        for folder in required.folders
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
    except KeyError:  # no user of this machine
        return str(path.stat().st_uid)


def _is_within(path: Path, folders: Iterable[Path]) -> bool:
    return any(place.is_relative_to(folder) for place in _both(path) for folder in folders)


def _both(path: Path) -> tuple[Path, Path]:
    """Return the absolute path, and the path without symbolic links."""
    return path.absolute(), Path(os.path.realpath(path))
