"""Unit of systemd for this installation."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template

from config.settings_files import SHIPPED_DIR
from kurt2rt.service.systemd.access import needs_home_access
from kurt2rt.service.systemd.unit_error import UnitCode, UnitError

MARK = "# Made by kurt2rt service install:"
"""First words of our files; other files are not touched."""
USER = "KURT2 robot"
"""Full name of the user of each of our units."""
STATE = Path("/var/lib")
"""Folder of the units' state: each unit has a folder of its name, which is its working directory."""
_TEMPLATES = SHIPPED_DIR / "service"
_NAME = re.compile(r"[a-z][a-z0-9-]{0,30}")
_PLAIN = re.compile(r"[\w@+,./:=-]+")


@dataclass(frozen=True, slots=True)
class Unit:
    """Texts of the files that make a systemd service of kurt2rt, and the user that it runs as."""

    name: str
    """Name of the unit and of its user."""
    service: str
    """Text of NAME.service."""
    sysusers: str
    """Text of NAME.conf, which makes the user."""


def build_unit(name: str, bus: str, command: Sequence[str], folders: Iterable[Path] = ()) -> Unit:
    """Return the unit that runs `command`, whose first word is an absolute path.

    `folders`: folders outside the unit's state that it writes. Raises UnitError for an invalid name, or words that
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
    """Raise UnitError for an invalid name of a unit and of its user."""
    if not _NAME.fullmatch(name):
        raise UnitError(UnitCode.BAD_NAME, where=repr(name))


def quoted(word: str) -> str:
    """Return a word quoted for a unit's command line or list of paths, as systemd.syntax(7) reads it back.

    Raises UnitError for a word that cannot stand in a unit.
    """
    free = _specifier_free(word)
    if _PLAIN.fullmatch(word):
        return free
    escaped = free.replace("\\", "\\\\").replace('"', '\\"').replace("$", "$$")
    return f'"{escaped}"'


def _specifier_free(text: str) -> str:
    if not text.isprintable():
        raise UnitError(UnitCode.UNPRINTABLE, where=repr(text))
    return text.replace("%", "%%")


def _filled(template: str, words: dict[str, str]) -> str:
    text = (_TEMPLATES / template).read_text(encoding="utf-8")
    return Template(text).substitute(words)
