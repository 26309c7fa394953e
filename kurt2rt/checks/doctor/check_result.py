"""Result of one check of the machine: a finding with its numbers and texts."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Self

_ANOTHER_FOLDER = "give a folder on a local disk that you may write, with --folder"
_LIMITS_FILE = "/etc/security/limits.d/kurt2rt.conf"
_OTHER_KERNEL = (
    "boot a kernel with CAN (Debian: linux-image-amd64; Ubuntu: linux-modules-extra-$(uname -r)); simulation needs none"
)
_SYNC = "median {median_ms:.2f} ms of {times}, worst {worst_ms:.2f} ms"
_TIMER = "{ticks} ticks of {period_ms:g} ms: median {median_ms:.3f} ms late, worst {worst_ms:.3f}"


class CheckStatus(StrEnum):
    """Judgement of one check of `kurt2rt doctor`: ok, a warning, or missing."""

    OK = "ok"
    WARNING = "warning"
    MISSING = "missing"


class FindingCode(StrEnum):
    """Code of what a check of `kurt2rt doctor` found, with its texts and remedy.

    The fields of the finding are in braces.
    """

    subject: str
    found: str
    what_to_do: str
    """One line, mostly a command to copy; empty if there is nothing to do."""

    def __new__(cls, value: str, subject: str, found: str, what_to_do: str = "") -> Self:
        """Make a member of a code and its texts."""
        member = str.__new__(cls, value)
        member._value_ = value
        member.subject, member.found, member.what_to_do = subject, found, what_to_do
        return member

    PACKAGE = ("package", "{name}", "{version}, for {used_for}")
    PACKAGE_MISSING = (
        "package missing",
        "{name}",
        "cannot be imported ({fault}), needed for {used_for}",
        "in the project's folder: {python} -m pip install -e '.[{extra}]'",
    )
    TIMER = ("timer", "timer", _TIMER)
    TIMER_LATE = (
        "timer late",
        "timer",
        f"{_TIMER}: ticks would come late or be missed",
        "end other programs, see CPU governor and real-time priority here, then run kurt2rt doctor again",
    )
    TIMER_MISSING = (
        "timer missing",
        "timer",
        "no timerfd ({error})",
        "run on Linux, outside of sandboxes that refuse timerfd_create",
    )
    PRIORITY = ("priority", "real-time priority", "SCHED_FIFO granted")
    PRIORITY_REFUSED = (
        "priority refused",
        "real-time priority",
        "not permitted ({error}), so ticks are missed while other programs are busy",
        "the unit of kurt2rt service install is permitted it; by hand: "
        f'echo "$USER - rtprio 50" | sudo tee -a {_LIMITS_FILE}, then log in again',
    )
    CORES = ("cores", "cores", "{usable} usable of {cores}")
    CORES_FEW = (
        "cores few",
        "cores",
        "{usable} usable of {cores}: ticks share it with all else",
        "run the teacher's page and the simulator on another machine, or allow more cores (taskset, cpuset)",
    )
    GOVERNOR_NONE = ("governor none", "CPU governor", "none to be read: a virtual machine, or a clock that is fixed")
    GOVERNOR = ("governor", "CPU governor", "{governors}")
    GOVERNOR_SAVING = (
        "governor saving",
        "CPU governor",
        "{governors}",
        "echo performance | sudo tee {folder}/cpu*/cpufreq/scaling_governor",
    )
    SQLITE_LOG = ("sqlite log", "SQLite log", "write-ahead log works next to a reader")
    SQLITE_LOG_FAILS = (
        "sqlite log fails",
        "SQLite log",
        "does not work in this folder: {fault}",
        "give a folder on a local disk with --folder",
    )
    FOLDER = ("folder", "knowledge folder", "{folder} can be written")
    FOLDER_TO_MAKE = (
        "folder to make",
        "knowledge folder",
        "{folder} is made when it is needed: {parent} can be written",
    )
    FOLDER_UNWRITABLE = (
        "folder unwritable",
        "knowledge folder",
        "{folder} cannot be written ({error})",
        _ANOTHER_FOLDER,
    )
    SPACE = ("space", "free space", "{free_gb:.1f} GB free")
    SPACE_LOW = ("space low", "free space", "{free_gb:.1f} GB free", f"make room, or {_ANOTHER_FOLDER}")
    SYNC = ("sync", "fsync", _SYNC)
    SYNC_SLOW = (
        "sync slow",
        "fsync",
        f"{_SYNC}: above {{limit_ms:g}} ms, the teacher waits for each lesson",
        f"use a faster disk: {_ANOTHER_FOLDER}",
    )
    CAN = ("can", "CAN in the kernel", "AF_CAN sockets can be opened")
    CAN_UNLOADED = ("can unloaded", "CAN in the kernel", "no AF_CAN socket ({error})", "sudo modprobe -a can can_raw")
    CAN_MISSING = ("can missing", "CAN in the kernel", "no AF_CAN socket ({error})", _OTHER_KERNEL)
    CAN_INTERFACE = ("can interface", "CAN interface {name}", "up")
    CAN_INTERFACE_NONE = (
        "can interface none",
        "CAN interface",
        "none with hardware in {folder}",
        "plug in the adapter, then: {up}",
    )
    CAN_INTERFACE_DOWN = ("can interface down", "CAN interface {name}", "down", "{up}")
    CAN_INTERFACE_OFF_BUS = (
        "can interface off bus",
        "CAN interface {name}",
        "up, but off the bus",
        "check cable, terminators and bit rate; sudo ip link set {name} down; {up}",
    )


@dataclass(frozen=True, slots=True)
class CheckResult:
    """Result of one check of `kurt2rt doctor`: a finding, and whether something is missing."""

    code: FindingCode
    status: CheckStatus
    values: Mapping[str, float | str] = field(default_factory=dict)
    """Fields of the code's texts."""
    needed: bool = False
    """True for a thing that `kurt2rt run` needs."""

    @property
    def subject(self) -> str:
        """Name of what was looked at."""
        return self.code.subject.format(**self.values)

    @property
    def found(self) -> str:
        """State that was found, in words."""
        return self.code.found.format(**self.values)

    @property
    def what_to_do(self) -> str:
        """Remedy, empty if there is nothing to do."""
        return self.code.what_to_do.format(**self.values)

    @property
    def forbids_run(self) -> bool:
        """True if `kurt2rt run` cannot start because of this."""
        return self.needed and self.status is CheckStatus.MISSING
