"""The unit of systemd, filled in for this installation."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template

from hal.errors import UserError
from hal.settings import SHIPPED_DIR
from kurt2rt.service.systemd.access import needs_home_access

MARK = "# Made by kurt2rt service install:"
"""How our files begin; others are not touched."""
USER = "KURT2 robot"
"""What the user of each of our units is called in full."""
STATE = Path("/var/lib")
"""Each unit keeps what is its own there, in a folder of its name, and is started in it."""
_TEMPLATES = SHIPPED_DIR / "service"
_NAME = re.compile(r"[a-z][a-z0-9-]{0,30}")
_PLAIN = re.compile(r"[\w@+,./:=-]+")


class UnitError(UserError):
    """A unit cannot be made, installed or checked."""


@dataclass(frozen=True, slots=True)
class Unit:
    """What is put on the disk."""

    name: str
    """Of the unit and of its user."""
    service: str
    """Text of NAME.service."""
    sysusers: str
    """Text of NAME.conf, which makes the user."""


def build_unit(name: str, bus: str, command: Sequence[str], folders: Iterable[Path] = ()) -> Unit:
    """The unit that runs `command`, whose first word is an absolute path.

    `folders`: beyond its own state it writes there, too. Raises UnitError for a name that is none, or words that
    cannot stand in a unit.
    """
    require_name(name)
    words = {
        "robot": _specifier_free(bus),
        "user": name,
        "called": USER,
        "mark": MARK,
        "command": " ".join(map(quoted, command)),
        "protect_home": "read-only" if needs_home_access() else "yes",
        "writable": "".join(f"ReadWritePaths=-{quoted(str(each))}\n" for each in sorted(set(folders))).rstrip(),
    }
    return Unit(name, _filled("kurt2rt.service", words), _filled("sysusers.conf", words))


def require_name(name: str) -> None:
    """Raises UnitError for what is no name of a unit and of its user."""
    if not _NAME.fullmatch(name):
        raise UnitError(
            "is no name for a unit and its user",
            where=repr(name),
            do="give up to 31 of a-z, 0-9 and -, a letter first",
        )


def quoted(word: str) -> str:
    """A word of a unit's command line or list of paths, as systemd.syntax(7) reads it back."""
    free = _specifier_free(word)
    if _PLAIN.fullmatch(word):
        return free
    escaped = free.replace("\\", "\\\\").replace('"', '\\"').replace("$", "$$")
    return f'"{escaped}"'


def _specifier_free(text: str) -> str:
    if not text.isprintable():
        raise UnitError("cannot stand in a unit", where=repr(text), do="give a path without control characters")
    return text.replace("%", "%%")


def _filled(template: str, words: dict[str, str]) -> str:
    text = (_TEMPLATES / template).read_text(encoding="utf-8")
    return Template(text).substitute(words)
