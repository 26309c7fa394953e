"""Checks of the knowledge folder: permission, space and time to durability."""

import shutil
import statistics
import tempfile
from pathlib import Path

from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode
from kurt2rt.checks.doctor.sqlite_log import check_sqlite_log
from kurt2rt.platform.fsync_probe import fsync_ns

SYNC_TIMES = 20
SYNC_LIMIT_S = 0.02
"""Limit of one fsync, the largest part of the 20 ms to a lesson's acknowledgement (design, Knowledge)."""
LEAST_BYTES = 64 * 1024 * 1024
WANTED_BYTES = 1024 * 1024 * 1024
"""Recommended free space, most of it for recorded runs."""


def check_disk(folder: Path) -> tuple[CheckResult, ...]:
    """Check the folder, or its nearest parent if it is missing. Leaves nothing behind."""
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
        values = {"folder": str(folder), "error": str(error)}
        return (CheckResult(FindingCode.FOLDER_UNWRITABLE, CheckStatus.MISSING, values, needed=True),)


def _check_folder(folder: Path, place: Path) -> CheckResult:
    if place == folder:
        return CheckResult(FindingCode.FOLDER, CheckStatus.OK, {"folder": str(folder)}, needed=True)
    return CheckResult(
        FindingCode.FOLDER_TO_MAKE, CheckStatus.OK, {"folder": str(folder), "parent": str(place)}, needed=True
    )


def check_free_space(folder: Path, least_bytes: int = LEAST_BYTES, wanted_bytes: int = WANTED_BYTES) -> CheckResult:
    """Check the space for knowledge and recorded runs on the disk of `folder`.

    Below `least_bytes` the robot cannot run; below `wanted_bytes` the check warns.
    """
    free_bytes = shutil.disk_usage(folder).free
    values = {"free_gb": free_bytes / 1e9}
    if free_bytes < wanted_bytes:
        status = CheckStatus.MISSING if free_bytes < least_bytes else CheckStatus.WARNING
        return CheckResult(FindingCode.SPACE_LOW, status, values, needed=True)
    return CheckResult(FindingCode.SPACE, CheckStatus.OK, values, needed=True)


def check_sync(folder: Path, limit_s: float = SYNC_LIMIT_S) -> CheckResult:
    """Measure the time until a page is durable in `folder`, against a limit in s."""
    with (folder / "sync").open("wb", buffering=0) as file:
        took_s = [fsync_ns(file) / 1e9 for _ in range(SYNC_TIMES)]
    median_s = statistics.median(took_s)
    took = {"median_ms": median_s * 1000, "times": SYNC_TIMES, "worst_ms": max(took_s) * 1000}
    values = {**took, "limit_ms": limit_s * 1000}
    if median_s > limit_s:
        return CheckResult(FindingCode.SYNC_SLOW, CheckStatus.WARNING, values, needed=True)
    return CheckResult(FindingCode.SYNC, CheckStatus.OK, values, needed=True)
