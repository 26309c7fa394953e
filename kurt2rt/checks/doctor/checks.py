"""All checks in the order of the report; here are those of Python, the processor and the knowledge folder."""

import os
import shutil
import sqlite3
import statistics
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Mapping
from contextlib import closing
from functools import cache
from importlib.metadata import packages_distributions, version
from pathlib import Path
from typing import BinaryIO

import numpy as np
from threadpoolctl import threadpool_info

from kurt2rt.checks.doctor.can_bus import check_can_interfaces, check_can_kernel, check_vcan
from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode
from kurt2rt.checks.doctor.privileges import check_memory_lock, check_real_time_priority
from kurt2rt.checks.doctor.sysfs import read_attribute
from kurt2rt.checks.doctor.timer import check_clock, check_timer

LEAST_PYTHON = (3, 11)
CPU_FOLDER = Path("/sys/devices/system/cpu")
SYNC_TIMES = 20
SYNC_LIMIT_S = 0.02
"""Limit of one fsync, the largest part of the 20 ms to a lesson's acknowledgement (design, Knowledge)."""
LEAST_BYTES = 64 * 1024 * 1024
WANTED_BYTES = 1024 * 1024 * 1024
"""Recommended free space, most of it for recorded runs."""
_PAGE_BYTES = 4096
LEAST_SQLITE = (3, 37, 0)
"""First version with STRICT tables."""


def run_checks(folder: Path, ticks: int = 100) -> tuple[CheckResult, ...]:
    """Run all checks; `folder` is that of the knowledge. Changes nothing. Takes 20 ms per tick."""
    return (
        check_python(),
        check_timer(ticks),
        check_clock(),
        check_real_time_priority(),
        check_memory_lock(),
        check_cores(),
        check_governor(),
        check_blas_threads(),
        check_sqlite(),
        *check_disk(folder),
        check_can_kernel(),
        *check_can_interfaces(),
        check_vcan(),
        check_package("foxglove", "recordings of runs", "recording"),
        check_package("pymunk", "the simulator's physics"),
        check_package("shapely", "the simulator's worlds"),
        check_package("matplotlib", "drawing to files, without a display"),
    )


def check_python(found: tuple[int, int, int] = sys.version_info[:3]) -> CheckResult:
    """Check that Python is new enough."""
    name = ".".join(map(str, found))
    if found[:2] < LEAST_PYTHON:
        least = ".".join(map(str, LEAST_PYTHON))
        return CheckResult(FindingCode.PYTHON_OLD, CheckStatus.MISSING, {"version": name, "least": least}, needed=True)
    return CheckResult(FindingCode.PYTHON, CheckStatus.OK, {"version": name}, needed=True)


def check_package(name: str, used_for: str, extra: str = "simulation", python: str = sys.executable) -> CheckResult:
    """Check that a package of an extra can be imported by the interpreter `python`.

    `used_for` and `extra`: for the advice. The import runs in another process, because a broken native library may
    crash the interpreter.
    """
    fault = _import_fault(name, python)
    if fault:
        values = {"name": name, "used_for": used_for, "fault": fault, "python": python, "extra": extra}
        return CheckResult(FindingCode.PACKAGE_MISSING, CheckStatus.MISSING, values)
    found = version(_distributions()[name][0])
    return CheckResult(FindingCode.PACKAGE, CheckStatus.OK, {"name": name, "used_for": used_for, "version": found})


@cache
def _distributions() -> Mapping[str, list[str]]:
    """Return the distributions of each package; to read the files of all of them takes 0.2 s."""
    return packages_distributions()


def _import_fault(name: str, python: str) -> str:
    """Return the last line of the import's error; empty without one."""
    try:
        trial = subprocess.run([python, "-c", f"import {name}"], capture_output=True, text=True, check=False)
    except OSError as error:
        return f"Python could not be started: {error}"
    if trial.returncode == 0:
        return ""
    said = trial.stderr.strip().splitlines()
    return said[-1] if said else f"the import ended with code {trial.returncode}"


def check_cores(usable: int | None = None) -> CheckResult:
    """Check for a core for the ticks and another for everything else. `usable`: number of cores; None: measure."""
    if usable is None:
        usable = len(os.sched_getaffinity(0))
    values = {"usable": usable, "cores": os.cpu_count() or usable}
    if usable < 2:
        return CheckResult(FindingCode.CORES_FEW, CheckStatus.WARNING, values)
    return CheckResult(FindingCode.CORES, CheckStatus.OK, values)


def check_governor(cpu_folder: Path = CPU_FOLDER) -> CheckResult:
    """Check that the cores stay at full clock; a core that idles between ticks wakes late and slow."""
    files = sorted(cpu_folder.glob("cpu[0-9]*/cpufreq/scaling_governor"))
    governors = Counter(governor for governor in map(read_attribute, files) if governor)
    if not governors:
        return CheckResult(FindingCode.GOVERNOR_NONE, CheckStatus.OK)
    found = ", ".join(f"{name} on {count} cores" for name, count in sorted(governors.items()))
    if set(governors) == {"performance"}:
        return CheckResult(FindingCode.GOVERNOR, CheckStatus.OK, {"governors": found})
    return CheckResult(
        FindingCode.GOVERNOR_SAVING, CheckStatus.WARNING, {"governors": found, "folder": str(cpu_folder)}
    )


def check_blas_threads() -> CheckResult:
    """Check that numpy's linear algebra uses one thread; a match is too small for more, and idle threads spin."""
    libraries = [each for each in threadpool_info() if each["user_api"] == "blas"]
    found = ", ".join(f"{each['internal_api']} {each['num_threads']}" for each in libraries) or "no BLAS that tells"
    values = {"numpy": np.__version__, "libraries": found}
    if all(each["num_threads"] == 1 for each in libraries):
        return CheckResult(FindingCode.BLAS, CheckStatus.OK, values)
    return CheckResult(FindingCode.BLAS_MANY, CheckStatus.WARNING, values)


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


def fsync_ns(file: BinaryIO) -> int:
    """Return the ns until one more page of an unbuffered file is durable. Raises OSError."""
    file.write(bytes(_PAGE_BYTES))
    begun_ns = time.perf_counter_ns()
    os.fsync(file.fileno())
    return time.perf_counter_ns() - begun_ns


def check_sqlite(found: tuple[int, ...] = sqlite3.sqlite_version_info) -> CheckResult:
    """Check that Python's SQLite is new enough for the journal."""
    name = ".".join(map(str, found))
    if found < LEAST_SQLITE:
        least = ".".join(map(str, LEAST_SQLITE))
        return CheckResult(FindingCode.SQLITE_OLD, CheckStatus.MISSING, {"version": name, "least": least}, needed=True)
    return CheckResult(FindingCode.SQLITE, CheckStatus.OK, {"version": name}, needed=True)


def check_sqlite_log(folder: Path) -> CheckResult:
    """Check that a write-ahead log works in this folder; on most network disks it does not."""
    path = folder / "log.sqlite"
    try:
        with closing(_connect(path)) as writer, closing(_connect(path)) as reader:
            fault = log_fault(writer, reader)
    except sqlite3.Error as error:
        fault = str(error)
    if fault:
        return CheckResult(FindingCode.SQLITE_LOG_FAILS, CheckStatus.MISSING, {"fault": fault}, needed=True)
    return CheckResult(FindingCode.SQLITE_LOG, CheckStatus.OK, needed=True)


def _connect(path: Path) -> sqlite3.Connection:
    return sqlite3.connect(path, timeout=0.2, isolation_level=None)


def log_fault(writer: sqlite3.Connection, reader: sqlite3.Connection) -> str:
    """Return the fault of a write during another program's read, in words; empty without a fault."""
    (mode,) = writer.execute("PRAGMA journal_mode = WAL").fetchone()
    if mode != "wal":
        return f"journal mode stays {mode}"
    writer.execute("PRAGMA synchronous = FULL")
    writer.execute("CREATE TABLE lesson (number INTEGER)")
    reader.execute("BEGIN")
    before = _lessons(reader)
    writer.execute("INSERT INTO lesson VALUES (1)")  # without a log this would wait for the reader, and fail
    during = _lessons(reader)
    reader.execute("COMMIT")
    seen = (before, during, _lessons(reader))
    return "" if seen == (0, 0, 1) else f"a reader saw {seen} lessons before, during and after, not (0, 0, 1)"


def _lessons(connection: sqlite3.Connection) -> int:
    (count,) = connection.execute("SELECT count(*) FROM lesson").fetchone()
    return int(count)
