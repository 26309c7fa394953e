"""Texts of the doctor's findings for the terminal."""

from collections.abc import Mapping
from typing import NamedTuple

from kurt2rt.checks.doctor.check_result import CheckResult
from kurt2rt.checks.doctor.check_result import FindingCode as Code

_ANOTHER_FOLDER = "give a folder on a local disk that you may write, with --folder"
_LIMITS_FILE = "/etc/security/limits.d/kurt2rt.conf"
_OTHER_KERNEL = (
    "boot a kernel with CAN (Debian: linux-image-amd64; Ubuntu: linux-modules-extra-$(uname -r)); simulation needs none"
)
_SYNC = "median {median_ms:.2f} ms of {times}, worst {worst_ms:.2f} ms"
_TIMER = (
    "{ticks} ticks of {period_ms:g} ms: timerfd median {median_ms:.3f} ms late, worst {worst_ms:.3f}; "
    "asyncio.sleep median {asyncio_median_ms:.3f} ms late, worst {asyncio_worst_ms:.3f}; ratio {ratio:.1f}"
)
_CLOCK = "resolution {resolution_ns:.0f} ns, source {source}"
_LIMIT_MIB = "RLIMIT_MEMLOCK {limit_mib:.0f} MiB"
_MAPPED = f"{_LIMIT_MIB}, a process like this one maps {{mapped_mib:.0f}} MiB"


class FindingText(NamedTuple):
    """Texts of one finding of `kurt2rt doctor`: its subject, what was found, and a remedy."""

    subject: str
    found: str
    what_to_do: str = ""
    """One line, mostly a command to copy; empty if there is nothing to do."""


_TEXTS: Mapping[Code, FindingText] = {
    Code.PYTHON: FindingText("Python", "{version}"),
    Code.PYTHON_OLD: FindingText("Python", "{version}", "install Python {least} or newer and make a new .venv with it"),
    Code.PACKAGE: FindingText("{name}", "{version}, for {used_for}"),
    Code.PACKAGE_MISSING: FindingText(
        "{name}",
        "cannot be imported ({fault}), needed for {used_for}",
        "in the project's folder: {python} -m pip install -e '.[{extra}]'",
    ),
    Code.TIMER: FindingText("timer", _TIMER),
    Code.TIMER_LATE: FindingText(
        "timer",
        f"{_TIMER}: ticks would come late or be missed",
        "end other programs, see CPU governor and real-time priority here, then run kurt2rt doctor again",
    ),
    Code.TIMER_MISSING: FindingText(
        "timer", "no timerfd ({error})", "run on Linux, outside of sandboxes that refuse timerfd_create"
    ),
    Code.CLOCK: FindingText("clock", _CLOCK),
    Code.CLOCK_COARSE: FindingText(
        "clock",
        f"{_CLOCK}: ticks would follow the kernel's jiffies",
        "use a kernel with CONFIG_HIGH_RES_TIMERS, booted without highres=off",
    ),
    Code.CLOCK_SLOW: FindingText(
        "clock", f"{_CLOCK}: slow to read", "boot with clocksource=tsc, if dmesg does not call the TSC unstable"
    ),
    Code.PRIORITY: FindingText(
        "real-time priority", "SCHED_FIFO granted; RLIMIT_RTPRIO {limit}, {capability} CAP_SYS_NICE"
    ),
    Code.PRIORITY_REFUSED: FindingText(
        "real-time priority",
        "not permitted ({error}), so ticks are missed while other programs are busy; "
        "RLIMIT_RTPRIO {limit}, {capability} CAP_SYS_NICE",
        "the unit of kurt2rt service install is permitted it; by hand: "
        f'echo "$USER - rtprio 50" | sudo tee -a {_LIMITS_FILE}, then log in again',
    ),
    Code.MEMORY_LOCK_UNLIMITED: FindingText("memory lock", "RLIMIT_MEMLOCK unlimited"),
    Code.MEMORY_LOCK_CAPABLE: FindingText("memory lock", f"{_LIMIT_MIB}, but CAP_IPC_LOCK sets no limit"),
    Code.MEMORY_LOCK_LARGE: FindingText("memory lock", _MAPPED),
    Code.MEMORY_LOCK_SMALL: FindingText(
        "memory lock", _MAPPED, f'echo "$USER - memlock unlimited" | sudo tee -a {_LIMITS_FILE}, then log in again'
    ),
    Code.CORES: FindingText("cores", "{usable} usable of {cores}"),
    Code.CORES_FEW: FindingText(
        "cores",
        "{usable} usable of {cores}: ticks share it with all else",
        "run the teacher's page and the simulator on another machine, or allow more cores (taskset, cpuset)",
    ),
    Code.GOVERNOR_NONE: FindingText("CPU governor", "none to be read: a virtual machine, or a clock that is fixed"),
    Code.GOVERNOR: FindingText("CPU governor", "{governors}"),
    Code.GOVERNOR_SAVING: FindingText(
        "CPU governor", "{governors}", "echo performance | sudo tee {folder}/cpu*/cpufreq/scaling_governor"
    ),
    Code.BLAS: FindingText("BLAS threads", "numpy {numpy}: {libraries}"),
    Code.BLAS_MANY: FindingText(
        "BLAS threads", "numpy {numpy}: {libraries}", "export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1"
    ),
    Code.SQLITE: FindingText("SQLite", "{version}"),
    Code.SQLITE_OLD: FindingText("SQLite", "{version}", "use a Python that brings SQLite {least} or newer"),
    Code.SQLITE_LOG: FindingText("SQLite log", "write-ahead log works next to a reader"),
    Code.SQLITE_LOG_FAILS: FindingText(
        "SQLite log", "does not work in this folder: {fault}", "give a folder on a local disk with --folder"
    ),
    Code.FOLDER: FindingText("knowledge folder", "{folder} can be written"),
    Code.FOLDER_TO_MAKE: FindingText("knowledge folder", "{folder} is made when it is needed: {parent} can be written"),
    Code.FOLDER_UNWRITABLE: FindingText("knowledge folder", "{folder} cannot be written ({error})", _ANOTHER_FOLDER),
    Code.SPACE: FindingText("free space", "{free_gb:.1f} GB free"),
    Code.SPACE_LOW: FindingText("free space", "{free_gb:.1f} GB free", f"make room, or {_ANOTHER_FOLDER}"),
    Code.SYNC: FindingText("fsync", _SYNC),
    Code.SYNC_SLOW: FindingText(
        "fsync",
        f"{_SYNC}: above {{limit_ms:g}} ms, the teacher waits for each lesson",
        f"use a faster disk: {_ANOTHER_FOLDER}",
    ),
    Code.CAN: FindingText("CAN in the kernel", "AF_CAN sockets can be opened"),
    Code.CAN_UNLOADED: FindingText("CAN in the kernel", "no AF_CAN socket ({error})", "sudo modprobe -a can can_raw"),
    Code.CAN_MISSING: FindingText("CAN in the kernel", "no AF_CAN socket ({error})", _OTHER_KERNEL),
    Code.CAN_INTERFACE: FindingText("CAN interface {name}", "up"),
    Code.CAN_INTERFACE_NONE: FindingText(
        "CAN interface", "none with hardware in {folder}", "plug in the adapter, then: {up}"
    ),
    Code.CAN_INTERFACE_DOWN: FindingText("CAN interface {name}", "down", "{up}"),
    Code.CAN_INTERFACE_OFF_BUS: FindingText(
        "CAN interface {name}",
        "up, but off the bus",
        "check cable, terminators and bit rate; sudo ip link set {name} down; {up}",
    ),
    Code.VCAN: FindingText("virtual CAN", "{name}, up"),
    Code.VCAN_DOWN: FindingText("virtual CAN", "{name}, down", "sudo ip link set {name} up"),
    Code.VCAN_NONE: FindingText(
        "virtual CAN",
        "no interface, but the module vcan is there",
        "sudo modprobe vcan && sudo ip link add dev vcan0 type vcan && sudo ip link set vcan0 up",
    ),
    Code.VCAN_NO_MODULE: FindingText("virtual CAN", "no interface, no module vcan in {folder}", _OTHER_KERNEL),
}


def text_of(finding: CheckResult) -> FindingText:
    """Return the texts of a finding: what was looked at, what was found, and what to do."""
    return FindingText(*(text.format(**finding.values) for text in _TEXTS[finding.code]))
