"""Texts of the access findings of a unit, each with the command or step that mends it."""

from collections.abc import Mapping
from pathlib import Path
from shlex import quote

from kurt2rt.service.systemd.access import AccessCode, AccessFinding

_COPIES = Path("/etc/kurt2rt")
_UNREADABLE = "{path}: the service's own user may not read it, for {closed} is closed to others"
_HIDDEN = "{path}: the service does not see what is in {closed}"
_COPY = "say: sudo install -D -m 644 {path_word} {copy_word}, and name that one"

_TEXTS: Mapping[AccessCode, str] = {
    AccessCode.INSTALLATION_UNREADABLE: f"{_UNREADABLE}; install kurt2rt where everybody may read, "
    "in a virtual environment in /opt/kurt2rt, for instance",
    AccessCode.FILE_UNREADABLE: f"{_UNREADABLE}; {_COPY}",
    AccessCode.FILE_HIDDEN: f"{_HIDDEN}; {_COPY}",
    AccessCode.FOLDER_HIDDEN: f"{_HIDDEN}; name a folder elsewhere",
    AccessCode.FOLDER_UNREACHABLE: "{path}: the service's own user cannot get there, for {closed} is closed to others; "
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
