"""The folder where knowledge is kept: can it be written, has it room, and how long does a lesson take to be durable?"""

import shutil
import statistics
import tempfile
from pathlib import Path

from kurt2rt.doctor.finding import Finding, Status
from kurt2rt.doctor.sqlite_log import check_sqlite_log
from kurt2rt.timing.disk import sync_ns

SYNC_TIMES = 20
SYNC_LIMIT_S = 0.02
"""A lesson is acknowledged within 20 ms, of which one fsync is most (design, Knowledge)."""
LEAST_BYTES = 64 * 1024 * 1024
WANTED_BYTES = 1024 * 1024 * 1024
"""Recorded runs take most of it."""

_ANOTHER_FOLDER = "give a folder on a local disk that you may write, with --folder"


def check_disk(folder: Path) -> tuple[Finding, ...]:
    """All about the folder, which need not be there: then its nearest parent is judged. Leaves nothing behind."""
    folder = folder.absolute()
    try:
        place = next(each for each in (folder, *folder.parents) if each.exists() or each.is_symlink())
        with tempfile.TemporaryDirectory(prefix=".kurt2rt-doctor-", dir=place) as scratch:
            return (
                _check_folder(folder, place),
                check_free_space(Path(scratch)),
                check_sync(Path(scratch)),
                check_sqlite_log(Path(scratch)),
            )
    except OSError as error:
        found = f"{folder} cannot be written ({error})"
        return (Finding("knowledge folder", Status.MISSING, found, _ANOTHER_FOLDER, needed=True),)


def _check_folder(folder: Path, place: Path) -> Finding:
    if place == folder:
        return Finding("knowledge folder", Status.OK, f"{folder} can be written", needed=True)
    found = f"{folder} is made when it is needed: {place} can be written"
    return Finding("knowledge folder", Status.OK, found, needed=True)


def check_free_space(folder: Path, least_bytes: int = LEAST_BYTES, wanted_bytes: int = WANTED_BYTES) -> Finding:
    """Is there room for knowledge and for recorded runs?"""
    free_bytes = shutil.disk_usage(folder).free
    found = f"{free_bytes / 1e9:.1f} GB free"
    if free_bytes < least_bytes:
        return Finding("free space", Status.MISSING, found, f"make room, or {_ANOTHER_FOLDER}", needed=True)
    if free_bytes < wanted_bytes:
        return Finding("free space", Status.WARNING, found, f"make room, or {_ANOTHER_FOLDER}", needed=True)
    return Finding("free space", Status.OK, found, needed=True)


def check_sync(folder: Path, limit_s: float = SYNC_LIMIT_S) -> Finding:
    """How long does the disk take until a page is durable?"""
    with (folder / "sync").open("wb", buffering=0) as file:
        took_s = [sync_ns(file) / 1e9 for _ in range(SYNC_TIMES)]
    median_s = statistics.median(took_s)
    found = f"median {median_s * 1000:.2f} ms of {SYNC_TIMES}, worst {max(took_s) * 1000:.2f} ms"
    if median_s > limit_s:
        found = f"{found}: above {limit_s * 1000:g} ms, the teacher waits for each lesson"
        return Finding("fsync", Status.WARNING, found, f"use a faster disk: {_ANOTHER_FOLDER}", needed=True)
    return Finding("fsync", Status.OK, found, needed=True)
