"""All checks in the order of the report; here are those of packages, the processor and the knowledge folder."""

import os
import shutil
import sqlite3
import statistics
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, closing
from functools import cache
from importlib.metadata import packages_distributions, version
from pathlib import Path
from typing import BinaryIO

import anyio

from kurt2rt.checks.doctor.can_bus import check_can_interfaces, check_can_kernel, read_attribute
from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode
from kurt2rt.platform.clock import Clock
from kurt2rt.platform.realtime_priority import UNIT_PRIORITY
from kurt2rt.platform.timerfd_clock import TimerfdClock

PERIOD_S = 0.01
TOLERABLE_MEDIAN_S = 0.001
"""Limit of the median lateness; a timerfd is about 0.1 ms late, the event loop's sleep 1 ms."""
CPU_FOLDER = Path("/sys/devices/system/cpu")
SYNC_TIMES = 20
SYNC_LIMIT_S = 0.02
"""Limit of one fsync, the largest part of the 20 ms to a lesson's acknowledgement (design, Knowledge)."""
LEAST_BYTES = 64 * 1024 * 1024
WANTED_BYTES = 1024 * 1024 * 1024
"""Recommended free space, most of it for recorded runs."""
_PAGE_BYTES = 4096
_HIGHEST_PRIORITY = UNIT_PRIORITY + 1
"""Priority of the threads that must preempt a hanging loop."""


def run_checks(folder: Path, ticks: int = 100) -> tuple[CheckResult, ...]:
    """Run all checks; `folder` is that of the knowledge. Changes nothing. Takes 10 ms per tick."""
    return (
        check_timer(ticks),
        check_real_time_priority(),
        check_cores(),
        check_governor(),
        *check_disk(folder),
        check_can_kernel(),
        *check_can_interfaces(),
        check_package("foxglove", "recordings of runs", "recording"),
        check_package("pymunk", "the simulator's physics"),
        check_package("shapely", "the simulator's worlds"),
        check_package("matplotlib", "drawing to files, without a display"),
    )


def check_timer(
    ticks: int = 100,
    period_s: float = PERIOD_S,
    open_clock: Callable[[], AbstractContextManager[Clock]] = TimerfdClock,
) -> CheckResult:
    """Check for a timerfd, and measure how late it wakes a waiting tick. Takes ticks x period_s."""

    async def measure() -> list[float]:
        late_s = []
        with open_clock() as clock:
            start_s = clock.now_s()
            for number in range(1, ticks + 1):
                deadline_s = start_s + number * period_s
                await clock.wait_until(deadline_s)
                late_s.append(clock.now_s() - deadline_s)
        return late_s

    try:
        late_s = anyio.run(measure)
    except OSError as error:
        return CheckResult(FindingCode.TIMER_MISSING, CheckStatus.MISSING, {"error": str(error)}, needed=True)
    median_s, worst_s = statistics.median(late_s), max(late_s)
    times = {"median_ms": median_s * 1000, "worst_ms": worst_s * 1000}
    values = {"ticks": ticks, "period_ms": period_s * 1000, **times}
    if median_s > TOLERABLE_MEDIAN_S or worst_s >= period_s:
        return CheckResult(FindingCode.TIMER_LATE, CheckStatus.WARNING, values, needed=True)
    return CheckResult(FindingCode.TIMER, CheckStatus.OK, values, needed=True)


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


def check_real_time_priority(
    set_scheduler: Callable[[int, int, os.sched_param], None] = os.sched_setscheduler,
) -> CheckResult:
    """Check that the kernel grants SCHED_FIFO at the service's priorities.

    A trial decides, because a control group may refuse. It runs in a thread that ends, so that nothing keeps the
    priority.
    """
    with ThreadPoolExecutor(max_workers=1) as thread:
        trial = thread.submit(set_scheduler, 0, os.SCHED_FIFO, os.sched_param(_HIGHEST_PRIORITY))
    try:
        trial.result()
    except OSError as error:
        return CheckResult(FindingCode.PRIORITY_REFUSED, CheckStatus.WARNING, {"error": str(error.strerror)})
    return CheckResult(FindingCode.PRIORITY, CheckStatus.OK)


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


def check_sqlite_log(folder: Path) -> CheckResult:
    """Check that a write-ahead log works in this folder; on most network disks it does not."""
    path = folder / "log.sqlite"
    try:
        with closing(_connect(path)) as writer, closing(_connect(path)) as reader:
            (mode,) = writer.execute("PRAGMA journal_mode = WAL").fetchone()
            fault = "" if mode == "wal" else f"journal mode stays {mode}"
            writer.execute("CREATE TABLE lesson (number INTEGER)")
            reader.execute("BEGIN")
            reader.execute("SELECT * FROM lesson").fetchall()
            writer.execute("INSERT INTO lesson VALUES (1)")  # without a log this would wait for the reader, and fail
    except sqlite3.Error as error:
        fault = str(error)
    if fault:
        return CheckResult(FindingCode.SQLITE_LOG_FAILS, CheckStatus.MISSING, {"fault": fault}, needed=True)
    return CheckResult(FindingCode.SQLITE_LOG, CheckStatus.OK, needed=True)


def _connect(path: Path) -> sqlite3.Connection:
    return sqlite3.connect(path, timeout=0.2, isolation_level=None)
