"""Files and folders that survive a power cut."""

import os
import shutil
from pathlib import Path


def fsync_folder(folder: Path) -> None:
    """Make the names in a folder durable after files were made, renamed or deleted. Raises OSError."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def make_private_folder(folder: Path) -> list[Path]:
    """Make a folder and its missing parents for this user alone, for knowledge and keys.

    Returns the folders that were made, the innermost first; an existing folder keeps its mode. Raises OSError.
    """
    missing = [each for each in (folder, *folder.parents) if not each.exists()]
    for each in reversed(missing):
        each.mkdir(mode=0o700, exist_ok=True)
    if not missing:
        folder.mkdir(mode=0o700, exist_ok=True)  # raises where a file has its name
    return missing


def make_folder(folder: Path) -> None:
    """Make a folder and its missing parents, and make their names durable; an existing folder is left alone.

    New folders are for this user alone. Raises OSError.
    """
    for each in make_private_folder(folder):
        fsync_folder(each.parent)


def free_bytes(path: Path) -> int:
    """Return the bytes that may still be written on the disk of `path`, which may not exist yet. Raises OSError."""
    path = path.absolute()
    return shutil.disk_usage(next(each for each in (path, *path.parents) if each.exists())).free


def fsync_file(path: Path) -> None:
    """Make the content of a file durable, whichever program wrote it. Raises OSError."""
    descriptor = os.open(path, os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def write_durably(path: Path, text: str) -> None:
    """Write a text file (UTF-8) instead of the one before; after a power cut it is whole, or as it was before.

    Raises OSError.
    """
    make_folder(path.parent)
    fresh = path.with_name(path.name + ".new")
    with fresh.open("w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    fresh.replace(path)
    fsync_folder(path.parent)
