"""Atomic writing of new files: whole or not there, and never in the place of another file."""

import hashlib
import os
import re
import unicodedata
from dataclasses import dataclass
from itertools import count
from pathlib import Path

from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.durable_files import fsync_folder

_LONGEST_PART = 32


@dataclass(frozen=True, slots=True)
class SavedCopy:
    """File that was saved for a teacher, as the answer names it; `/file` reads it by its name."""

    name: str
    """File name, without its folder."""
    sha256: str
    """Hexadecimal, of the file's bytes."""
    size_bytes: int


def write_numbered(content: bytes, folder: Path, parts: tuple[str, ...], ending: str) -> SavedCopy:
    """Save `content` in `folder`, which is made if it is missing; durable on return.

    The name joins those `parts` that are not empty, then `ending`; it gets a number if such a file is there already.
    Raises KnowledgeError if the disk does not take it.
    """
    stem = "-".join(part for part in parts if part)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for number in count(1):
            name = f"{stem}{ending}" if number == 1 else f"{stem}-{number}{ending}"
            if _write_if_free(content, folder, name):
                break
        fsync_folder(folder)
    except OSError as error:
        raise KnowledgeError(KnowledgeCode.FOLDER_NOT_WRITABLE, where=folder, error=error) from error
    return SavedCopy(name, hashlib.sha256(content).hexdigest(), len(content))


def write_new(content: bytes, path: Path) -> None:
    """Save `content` at `path`, where no file may be yet; durable on return.

    The temporary file of a program that was killed is removed. Raises KnowledgeError if a file is there, or the disk
    does not take it.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        (path.parent / _temporary_name(path.name)).unlink(missing_ok=True)
        written = _write_if_free(content, path.parent, path.name)
        fsync_folder(path.parent)
    except OSError as error:
        raise KnowledgeError(KnowledgeCode.NOT_SAVED, where=path, error=error) from error
    if not written:
        raise KnowledgeError(KnowledgeCode.ALREADY_THERE, where=path)


def plain_part(text: str) -> str:
    """Return the part of a text that may stand in a file name: a-z, 0-9, single hyphens, at most 32; may be empty."""
    letters = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode().lower()
    return re.sub(r"[^a-z0-9]+", "-", letters).strip("-")[:_LONGEST_PART].rstrip("-")


def stamp_part(stamp: str) -> str:
    """Return a stamp (UTC, ISO 8601) to the second, as it may stand in a file name: 20040426T100000."""
    return re.sub(r"[^0-9T]", "", stamp[:19])


def _temporary_name(name: str) -> str:
    return f".{name}.unborn"


def _write_if_free(content: bytes, folder: Path, name: str) -> bool:
    """Save under exactly this name; return False if it is taken."""
    path, temporary = folder / name, folder / _temporary_name(name)
    try:
        file = temporary.open("xb")  # reserves the name while it is there: renaming replaces another's file
    except FileExistsError:
        return False
    try:
        with file:
            if os.path.lexists(path):
                return False
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.rename(path)
    finally:
        temporary.unlink(missing_ok=True)
    return True
