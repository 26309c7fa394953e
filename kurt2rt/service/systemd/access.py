"""File access of the unit's own user."""

import os
import stat
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from shlex import quote

from kurt2rt.service.systemd.installation import required_paths

_HOMES = (Path("/home"), Path("/root"), Path("/run/user"))
_OF_ITS_OWN = (Path("/tmp"), Path("/var/tmp"), Path("/dev"))  # PrivateTmp and PrivateDevices
_COPIES = Path("/etc/kurt2rt")
_UNREADABLE = "{path}: the service's user cannot read it, because {closed} is closed to others"
_HIDDEN = "{path}: the service does not see what is in {closed}"
_COPY = "say: sudo install -D -m 644 {path_word} {copy_word}, and name that one"


class AccessCode(StrEnum):
    """Obstacle between the unit's user and a path; the code decides what mends it."""

    INSTALLATION_UNREADABLE = "installation unreadable"
    FILE_UNREADABLE = "file unreadable"
    FILE_HIDDEN = "file hidden"
    """The unit does not see the folder that holds the file."""
    FOLDER_HIDDEN = "folder hidden"
    FOLDER_UNREACHABLE = "folder unreachable"
    """A folder above it is closed to other users."""
    FOLDER_OF_ANOTHER = "folder of another"
    """Another user owns the folder, so the unit's user may not write it."""


@dataclass(frozen=True, slots=True)
class AccessFinding:
    """Path that the unit's user cannot use; `kurt2rt.service.systemd.access` has the texts."""

    code: AccessCode
    path: Path
    closed: Path | None = None
    """File or folder that is in the way; None for a folder of another user."""
    owner: str = ""
    """Owner of a folder of another user."""
    user: str = ""
    """User of the unit, for a folder of another user."""


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


def private_paths(required: RequiredAccess) -> tuple[AccessFinding, ...]:
    """Return a finding for each path that the unit's user cannot reach; empty if the unit can start."""
    installation = (_unreadable(path, AccessCode.INSTALLATION_UNREADABLE) for path in required_paths())
    files = (
        _unreadable(path, AccessCode.FILE_UNREADABLE) or _hidden(path, AccessCode.FILE_HIDDEN)
        for path in required.files
    )
    folders = (_hidden(path, AccessCode.FOLDER_HIDDEN) or _unreachable(path) for path in required.folders)
    return tuple(dict.fromkeys(each for each in (*installation, *files, *folders) if each is not None))


def paths_to_chown(user: str, required: RequiredAccess) -> tuple[AccessFinding, ...]:
    """Return a finding for each existing folder that `user` may not write; `user` need not exist yet."""
    return tuple(
        AccessFinding(AccessCode.FOLDER_OF_ANOTHER, folder, owner=_owner(folder), user=user)
        for folder in required.folders
        if folder.is_dir() and _owner(folder) != user and not folder.stat().st_mode & stat.S_IWOTH
    )


def _hidden(path: Path, code: AccessCode) -> AccessFinding | None:
    hides = _OF_ITS_OWN if needs_home_access() else (*_HOMES, *_OF_ITS_OWN)
    return next((AccessFinding(code, path, folder) for folder in hides if _is_within(path, (folder,))), None)


def _unreadable(path: Path, code: AccessCode) -> AccessFinding | None:
    for start in _both(path):
        for place in (start, *start.parents):
            wanted = stat.S_IXOTH if place.is_dir() else stat.S_IROTH
            if place.exists() and not place.stat().st_mode & wanted:
                return AccessFinding(code, path, place)
    return None


def _unreachable(folder: Path) -> AccessFinding | None:
    for start in _both(folder):
        for place in start.parents:
            if place.exists() and not place.stat().st_mode & stat.S_IXOTH:
                return AccessFinding(AccessCode.FOLDER_UNREACHABLE, folder, place)
    return None


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


_TEXTS: Mapping[AccessCode, str] = {
    AccessCode.INSTALLATION_UNREADABLE: f"{_UNREADABLE}; install kurt2rt in a folder for all, such as /opt/kurt2rt",
    AccessCode.FILE_UNREADABLE: f"{_UNREADABLE}; {_COPY}",
    AccessCode.FILE_HIDDEN: f"{_HIDDEN}; {_COPY}",
    AccessCode.FOLDER_HIDDEN: f"{_HIDDEN}; name a folder elsewhere",
    AccessCode.FOLDER_UNREACHABLE: "{path}: the service's user cannot get there, because {closed} is closed to others; "
    "name a folder elsewhere, or say: sudo chmod o+x {closed_word}",
    AccessCode.FOLDER_OF_ANOTHER: "{path}: belongs to {owner}; say: sudo chown {user}: {path_word}",
}


def access_text(finding: AccessFinding) -> str:
    """Return the finding and its cure in a line; paths in commands are quoted for a shell."""
    return _TEXTS[finding.code].format(
        path=finding.path,
        path_word=quote(str(finding.path)),
        copy_word=quote(str(_COPIES / finding.path.name)),
        closed=finding.closed,
        closed_word=quote(str(finding.closed)),
        owner=finding.owner,
        user=finding.user,
    )
