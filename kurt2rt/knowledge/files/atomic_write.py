"""A file that is saved under a name made here: whole or not there at all, and never in the place of another one."""

import hashlib
import os
import re
import unicodedata
from dataclasses import dataclass
from itertools import count
from pathlib import Path

from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.durable_files import fsync_folder

_LONGEST_PART = 32


@dataclass(frozen=True, slots=True)
class SavedCopy:
    """What was saved."""

    name: str
    """File name, without its folder."""
    sha256: str
    """Of the file's bytes, hexadecimal."""
    size_bytes: int


def write_numbered(content: bytes, folder: Path, parts: tuple[str, ...], ending: str) -> SavedCopy:
    """Save `content` in `folder`, which is made where it is missing, durable on return.

    The name is made of `parts`, as far as they have letters, and `ending`, with a number where such a file is there
    already. Raises KnowledgeError.
    """
    stem = "-".join(part for part in parts if part)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for number in count(1):
            name = f"{stem}{ending}" if number == 1 else f"{stem}-{number}{ending}"
            if _is_born(content, folder, name):
                break
        fsync_folder(folder)
    except OSError as error:
        raise KnowledgeError(
            f"nothing can be saved there ({error})", where=folder, do="give a folder that may be written and has room"
        ) from error
    return SavedCopy(name, hashlib.sha256(content).hexdigest(), len(content))


def write_new(content: bytes, path: Path) -> None:
    """Save `content` at `path`, where nothing may be yet; durable on return. Raises KnowledgeError.

    What a program that was killed began there is in nobody's way: nothing but a whole file ever has the name.
    """
    unborn = path.parent / _unborn(path.name)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        unborn.unlink(missing_ok=True)
        born = _is_born(content, path.parent, path.name)
        fsync_folder(path.parent)
    except OSError as error:
        raise KnowledgeError(
            f"cannot be saved ({error})", where=path, do="give a path in a folder that may be written and has room"
        ) from error
    if not born:
        raise KnowledgeError("is there already", where=path, do="give the path of a new file")


def plain_part(text: str) -> str:
    """What of a text may stand in a file name: a-z, 0-9 and single hyphens, at most 32; may be empty."""
    letters = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode().lower()
    return re.sub(r"[^a-z0-9]+", "-", letters).strip("-")[:_LONGEST_PART].rstrip("-")


def stamp_part(stamp: str) -> str:
    """A stamp (UTC, ISO 8601) to the second, as it may stand in a file name: 20040426T100000."""
    return re.sub(r"[^0-9T]", "", stamp[:19])


def _unborn(name: str) -> str:
    return f".{name}.unborn"


def _is_born(content: bytes, folder: Path, name: str) -> bool:
    """Save under exactly this name; False where it is taken."""
    path, unborn = folder / name, folder / _unborn(name)
    try:
        file = unborn.open("xb")  # as long as it is there the name is ours: renaming would replace another's file
    except FileExistsError:
        return False
    try:
        with file:
            if os.path.lexists(path):
                return False
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        unborn.rename(path)
    finally:
        unborn.unlink(missing_ok=True)
    return True
