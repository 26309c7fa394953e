"""Checks of the user's permissions: real-time priority and locked memory."""

import os
import resource
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode
from kurt2rt.platform.realtime_priority import UNIT_PRIORITY

SELF_STATUS = Path("/proc/self/status")
_CAP_IPC_LOCK = 14
_CAP_SYS_NICE = 23
_HIGHEST_PRIORITY = UNIT_PRIORITY + 1
"""Priority of the threads that must preempt a hanging loop."""
_MIB = 1024 * 1024


def check_real_time_priority(
    limit: int | None = None,
    set_scheduler: Callable[[int, int, os.sched_param], None] = os.sched_setscheduler,
    status: Path = SELF_STATUS,
) -> CheckResult:
    """Check that the kernel grants SCHED_FIFO at the service's priorities.

    A trial decides, because a control group may refuse. It runs in a thread that ends, so that nothing keeps the
    priority.
    """
    if limit is None:
        limit = resource.getrlimit(resource.RLIMIT_RTPRIO)[0]
    capability = "with" if _has_capability(_CAP_SYS_NICE, status) else "without"
    values = {"limit": _format_limit(limit), "capability": capability}
    with ThreadPoolExecutor(max_workers=1) as thread:
        trial = thread.submit(set_scheduler, 0, os.SCHED_FIFO, os.sched_param(_HIGHEST_PRIORITY))
    try:
        trial.result()
    except OSError as error:
        return CheckResult(FindingCode.PRIORITY_REFUSED, CheckStatus.WARNING, {**values, "error": str(error.strerror)})
    return CheckResult(FindingCode.PRIORITY, CheckStatus.OK, values)


def check_memory_lock(limit_bytes: int | None = None, status: Path = SELF_STATUS) -> CheckResult:
    """Check that a process of this size may lock its memory against page faults."""
    if limit_bytes is None:
        limit_bytes = resource.getrlimit(resource.RLIMIT_MEMLOCK)[0]
    if limit_bytes == resource.RLIM_INFINITY:
        return CheckResult(FindingCode.MEMORY_LOCK_UNLIMITED, CheckStatus.OK)
    values = {"limit_mib": limit_bytes / _MIB}
    if _has_capability(_CAP_IPC_LOCK, status):
        return CheckResult(FindingCode.MEMORY_LOCK_CAPABLE, CheckStatus.OK, values)
    # mlockall counts what is mapped, not what is resident; VmSize is in kB of 1024.
    mapped_bytes = int(_status_field("VmSize", status).split()[0]) * 1024
    values["mapped_mib"] = mapped_bytes / _MIB
    if limit_bytes >= mapped_bytes:
        return CheckResult(FindingCode.MEMORY_LOCK_LARGE, CheckStatus.OK, values)
    return CheckResult(FindingCode.MEMORY_LOCK_SMALL, CheckStatus.WARNING, values)


def _has_capability(number: int, status: Path) -> bool:
    return bool(int(_status_field("CapEff", status), 16) >> number & 1)


def _status_field(name: str, status: Path) -> str:
    lines = status.read_text(encoding="utf-8", errors="replace").splitlines()
    fields = dict(line.split(":", 1) for line in lines if ":" in line)
    return fields[name].strip()


def _format_limit(limit: int) -> str:
    return "unlimited" if limit == resource.RLIM_INFINITY else str(limit)
