"""This installation, and the file access that the unit's own user has to it and to the settings."""

import os
import stat
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from shlex import quote

from config.settings_files import SHIPPED_DIR
from kurt2rt.service.systemd.unit_error import UnitCode, UnitError

_HOMES = (Path("/home"), Path("/root"), Path("/run/user"))
_OF_ITS_OWN = (Path("/tmp"), Path("/var/tmp"), Path("/dev"))  # PrivateTmp and PrivateDevices
_COPIES = Path("/etc/kurt2rt")


@dataclass(frozen=True, slots=True)
class RequiredAccess:
    """Files and folders outside the unit's own folder that a service's user needs by its settings."""

    files: tuple[Path, ...] = ()
    """Absolute paths that the service reads."""
    folders: tuple[Path, ...] = ()
    """Absolute paths that the service writes; their disk may be mounted later."""


def start_command() -> tuple[str, ...]:
    """Return the words that start kurt2rt, with absolute paths."""
    script = Path(sys.executable).with_name("kurt2rt")
    if script.is_file():
        return (str(script),)
    # Without -P the present folder, which may be the service's own state, would be searched for modules.
    return (sys.executable, "-P", "-m", "kurt2rt.cli.main")


def required_paths() -> tuple[Path, ...]:
    """Return the files and folders of this installation that a service must be able to read."""
    return (Path(start_command()[0]), Path(sys.prefix), Path(sys.base_prefix), SHIPPED_DIR)


def needs_home_access() -> bool:
    """Return whether the unit needs access to homes, because this installation is in one."""
    return any(_is_within(path, _HOMES) for path in required_paths())


def require_access(required: RequiredAccess) -> None:
    """Raise UnitError for the first path that the unit's user cannot reach."""
    for path in required_paths():
        _require_readable(path, UnitCode.INSTALLATION_UNREADABLE)
    for path in required.files:
        _require_readable(path, UnitCode.FILE_UNREADABLE)
        _require_seen(path, UnitCode.FILE_HIDDEN)
    for path in required.folders:
        _require_seen(path, UnitCode.FOLDER_HIDDEN)
        _require_reachable(path)


def paths_to_chown(user: str, required: RequiredAccess) -> tuple[UnitError, ...]:
    """Return an error for each existing folder that `user` may not write; `user` need not exist yet."""
    return tuple(
        _obstacle(UnitCode.FOLDER_OF_ANOTHER, folder, folder, owner=_owner(folder), user=user)
        for folder in required.folders
        if folder.is_dir() and _owner(folder) != user and not folder.stat().st_mode & stat.S_IWOTH
    )


def _obstacle(code: UnitCode, path: Path, closed: Path, **fields: str) -> UnitError:
    """Return the error of a path; those in commands are quoted for a shell. `closed`: what is in the way."""
    words = {"path_word": path, "copy_word": _COPIES / path.name, "closed_word": closed}
    quoted = {name: quote(str(each)) for name, each in words.items()}
    return UnitError(code, where=path, closed=closed, **quoted, **fields)


def _require_seen(path: Path, code: UnitCode) -> None:
    for folder in _OF_ITS_OWN if needs_home_access() else (*_HOMES, *_OF_ITS_OWN):
        if _is_within(path, (folder,)):
            raise _obstacle(code, path, folder)


def _require_readable(path: Path, code: UnitCode) -> None:
    for start in _both(path):
        for place in (start, *start.parents):
            wanted = stat.S_IXOTH if place.is_dir() else stat.S_IROTH
            if place.exists() and not place.stat().st_mode & wanted:
                raise _obstacle(code, path, place)


def _require_reachable(folder: Path) -> None:
    for start in _both(folder):
        for place in start.parents:
            if place.exists() and not place.stat().st_mode & stat.S_IXOTH:
                raise _obstacle(UnitCode.FOLDER_UNREACHABLE, folder, place)


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
