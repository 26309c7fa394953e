"""Real-time priority and memory lock: asked of the kernel, without keeping anything."""

import os
import resource
import threading
from pathlib import Path

import pytest

from kurt2rt.checks.doctor.check_result import CheckStatus, FindingCode
from kurt2rt.checks.doctor.privileges import check_memory_lock, check_real_time_priority

NOTHING = "0000000000000000"
IPC_LOCK = "0000000000004000"
SYS_NICE = "0000000000800000"
MIB = 1024 * 1024


def status_file(folder: Path, capabilities: str, mapped_kb: int = 300 * 1024) -> Path:
    path = folder / "status"
    path.write_text(f"Name:\tpython: x\nVmSize:\t  {mapped_kb} kB\nCapEff:\t{capabilities}\n")
    return path


def test_the_trial_changes_nothing_that_lasts() -> None:
    policy, priority, threads = os.sched_getscheduler(0), os.sched_getparam(0).sched_priority, threading.enumerate()
    check_real_time_priority()
    assert (os.sched_getscheduler(0), os.sched_getparam(0).sched_priority) == (policy, priority)
    assert set(threading.enumerate()) <= set(threads)


def test_a_refusal_says_how_to_be_granted_it_next_time(tmp_path: Path) -> None:
    def refuse(pid: int, policy: int, parameters: os.sched_param) -> None:
        raise PermissionError(1, f"Operation not permitted: {pid} {policy} {parameters.sched_priority}")

    finding = check_real_time_priority(0, refuse, status_file(tmp_path, NOTHING))
    assert finding.status is CheckStatus.WARNING
    assert finding.code is FindingCode.PRIORITY_REFUSED
    assert finding.values == {
        "limit": "0",
        "capability": "without",
        "error": "Operation not permitted: 0 1 21",
    }
    assert not finding.forbids_run


@pytest.mark.parametrize(
    ("limit_bytes", "capabilities", "status"),
    [
        (resource.RLIM_INFINITY, NOTHING, CheckStatus.OK),
        (8 * MIB, IPC_LOCK, CheckStatus.OK),
        (300 * MIB, NOTHING, CheckStatus.OK),
        (300 * MIB - 1, NOTHING, CheckStatus.WARNING),
        (8 * MIB, SYS_NICE, CheckStatus.WARNING),
    ],
)
def test_memory_can_be_locked_when_the_whole_process_fits(
    limit_bytes: int, capabilities: str, status: CheckStatus, tmp_path: Path
) -> None:
    finding = check_memory_lock(limit_bytes, status_file(tmp_path, capabilities))
    assert finding.status is status
    assert (finding.code is FindingCode.MEMORY_LOCK_SMALL) == (status is CheckStatus.WARNING)
