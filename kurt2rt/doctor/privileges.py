"""What the kernel lets this user do: real-time priority and locked memory."""

import os
import resource
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from kurt2rt.doctor.finding import Finding, Status
from kurt2rt.timing.priority import UNIT_PRIORITY

SELF_STATUS = Path("/proc/self/status")
_CAP_IPC_LOCK = 14
_CAP_SYS_NICE = 23
_HIGHEST_PRIORITY = UNIT_PRIORITY + 1
"""Of the threads that have to overtake a loop that hangs."""
_MIB = 1024 * 1024
_LIMITS_FILE = "/etc/security/limits.d/kurt2rt.conf"


def check_real_time_priority(
    limit: int | None = None,
    set_scheduler: Callable[[int, int, os.sched_param], None] = os.sched_setscheduler,
    status: Path = SELF_STATUS,
) -> Finding:
    """Does the kernel grant SCHED_FIFO at the priorities of a unit? The trial decides: a control group may refuse.

    The trial is made by a thread that then ends, so nothing keeps the priority. Limit and capability are shown.
    """
    if limit is None:
        limit = resource.getrlimit(resource.RLIMIT_RTPRIO)[0]
    capability = "with" if _has_capability(_CAP_SYS_NICE, status) else "without"
    found = f"RLIMIT_RTPRIO {_shown(limit)}, {capability} CAP_SYS_NICE"
    with ThreadPoolExecutor(max_workers=1) as thread:
        trial = thread.submit(set_scheduler, 0, os.SCHED_FIFO, os.sched_param(_HIGHEST_PRIORITY))
    try:
        trial.result()
    except OSError as error:
        return Finding(
            "real-time priority",
            Status.WARNING,
            f"not permitted ({error.strerror}), so ticks are missed while other programs are busy; {found}",
            "the unit of kurt2rt service install is permitted it; by hand: "
            f'echo "$USER - rtprio 50" | sudo tee -a {_LIMITS_FILE}, then log in again',
        )
    return Finding("real-time priority", Status.OK, f"SCHED_FIFO granted; {found}")


def check_memory_lock(limit_bytes: int | None = None, status: Path = SELF_STATUS) -> Finding:
    """May a process as large as this one lock its memory, so that no tick waits for a page from the disk?"""
    if limit_bytes is None:
        limit_bytes = resource.getrlimit(resource.RLIMIT_MEMLOCK)[0]
    unlimited = limit_bytes == resource.RLIM_INFINITY
    found = f"RLIMIT_MEMLOCK {'unlimited' if unlimited else f'{limit_bytes / _MIB:.0f} MiB'}"
    if unlimited:
        return Finding("memory lock", Status.OK, found)
    if _has_capability(_CAP_IPC_LOCK, status):
        return Finding("memory lock", Status.OK, f"{found}, but CAP_IPC_LOCK sets no limit")
    # mlockall counts what is mapped, not what is resident; VmSize is in kB of 1024.
    mapped_bytes = int(_status_field("VmSize", status).split()[0]) * 1024
    found = f"{found}, a process like this one maps {mapped_bytes / _MIB:.0f} MiB"
    if limit_bytes >= mapped_bytes:
        return Finding("memory lock", Status.OK, found)
    return Finding(
        "memory lock",
        Status.WARNING,
        found,
        f'echo "$USER - memlock unlimited" | sudo tee -a {_LIMITS_FILE}, then log in again',
    )


def _has_capability(number: int, status: Path) -> bool:
    return bool(int(_status_field("CapEff", status), 16) >> number & 1)


def _status_field(name: str, status: Path) -> str:
    lines = status.read_text(encoding="utf-8", errors="replace").splitlines()
    fields = dict(line.split(":", 1) for line in lines if ":" in line)
    return fields[name].strip()


def _shown(limit: int) -> str:
    return "unlimited" if limit == resource.RLIM_INFINITY else str(limit)
