"""The unit of systemd, filled in for this installation."""

import os
import re
import stat
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template

from config import CONFIG_DIR
from kurt2rt.systemd.error import UnitError

_TEMPLATES = CONFIG_DIR / "service"
_NAME = re.compile(r"[a-z][a-z0-9-]{0,30}")
_PLAIN = re.compile(r"[\w@+,./:=-]+")
_HOMES = (Path("/home"), Path("/root"), Path("/run/user"))


@dataclass(frozen=True, slots=True)
class Unit:
    """What is put on the disk."""

    name: str
    """Of the unit and of its user."""
    service: str
    """Text of NAME.service."""
    sysusers: str
    """Text of NAME.conf, which makes the user."""


def unit_of(name: str, bus: str, command: Sequence[str], folders: Iterable[Path] = ()) -> Unit:
    """The unit that runs `command`, whose first word is an absolute path.

    `folders`: beyond its own state it writes there, too. Raises UnitError for a name that is none, or words that
    cannot stand in a unit.
    """
    if not _NAME.fullmatch(name):
        raise UnitError(
            f"{name!r}: is no name for a unit and its user; give up to 31 of a-z, 0-9 and -, a letter first"
        )
    of_homes = any(_is_within(path, _HOMES) for path in _of_this_installation())
    words = {
        "robot": _specifier_free(bus),
        "user": name,
        "command": " ".join(map(quoted, command)),
        "protect_home": "read-only" if of_homes else "yes",
        "writable": "".join(f"ReadWritePaths=-{quoted(str(each))}\n" for each in sorted(set(folders))).rstrip(),
    }
    return Unit(name, _filled("kurt2rt.service", words), _filled("sysusers.conf", words))


def program() -> tuple[str, ...]:
    """The words that start this very installation of kurt2rt, absolute."""
    script = Path(sys.executable).with_name("kurt2rt")
    if script.is_file():
        return (str(script),)
    # Without -P the state folder, which the service writes, would be searched for modules.
    return (sys.executable, "-P", "-m", "kurt2rt.cli.main")


def closed_to_others() -> str:
    """Why the service's own user, a stranger here, could not read this installation, in a line; empty when he can."""
    for path in _of_this_installation():
        for start in (path.absolute(), Path(os.path.realpath(path))):
            for place in (start, *start.parents):
                wanted = stat.S_IXOTH if place.is_dir() else stat.S_IROTH
                if place.exists() and not place.stat().st_mode & wanted:
                    return (
                        f"{path}: the service's own user may not read it, for {place} is closed to others; install "
                        "kurt2rt where everybody may read, in a virtual environment in /opt/kurt2rt, for instance"
                    )
    return ""


def quoted(word: str) -> str:
    """A word of a unit's command line or list of paths, as systemd.syntax(7) reads it back."""
    free = _specifier_free(word)
    if _PLAIN.fullmatch(word):
        return free
    escaped = free.replace("\\", "\\\\").replace('"', '\\"').replace("$", "$$")
    return f'"{escaped}"'


def _specifier_free(text: str) -> str:
    if not text.isprintable():
        raise UnitError(f"{text!r}: cannot stand in a unit; give a path without control characters")
    return text.replace("%", "%%")


def _filled(template: str, words: dict[str, str]) -> str:
    text = (_TEMPLATES / template).read_text(encoding="utf-8")
    return Template(text).substitute(words)


def _of_this_installation() -> tuple[Path, ...]:
    return (Path(program()[0]), Path(sys.prefix), Path(sys.base_prefix), CONFIG_DIR)


def _is_within(path: Path, folders: Iterable[Path]) -> bool:
    places = (path.absolute(), Path(os.path.realpath(path)))
    return any(place.is_relative_to(folder) for place in places for folder in folders)
