"""Checks of the processor: cores, clock and numpy's threads."""

import os
from collections import Counter
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_info

from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode
from kurt2rt.checks.doctor.sysfs import read_attribute

CPU_FOLDER = Path("/sys/devices/system/cpu")


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
