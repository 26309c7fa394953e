"""Result of one check of the machine: a finding with its numbers and texts."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from config.errors import TextCode

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


class FindingCode(TextCode):
    """Code of what a check of `kurt2rt doctor` found, with its texts; its remedy is mostly a command to copy."""

    subject: str
    """Name of what was looked at, with the fields of the finding in braces."""

    def __init__(self, _value: str, _text: str = "", _do: str = "", subject: str = "") -> None:
        """Keep what TextCode does not."""
        self.subject = subject

    PACKAGE = ("package", "{version}, for {used_for}", "", "{name}")
    PACKAGE_MISSING = (
        "package missing",
        "cannot be imported ({fault}), needed for {used_for}",
        "in the project's folder: {python} -m pip install -e '.[{extra}]'",
        "{name}",
    )
    TIMER = ("timer", _TIMER, "", "timer")
    TIMER_LATE = (
        "timer late",
        f"{_TIMER}: ticks would come late or be missed",
        "end other programs, see CPU governor and real-time priority here, then run kurt2rt doctor again",
        "timer",
    )
    TIMER_MISSING = (
        "timer missing",
        "no timerfd ({error})",
        "run on Linux, outside of sandboxes that refuse timerfd_create",
        "timer",
    )
    PRIORITY = ("priority", "SCHED_FIFO granted", "", "real-time priority")
    PRIORITY_REFUSED = (
        "priority refused",
        "not permitted ({error}), so ticks are missed while other programs are busy",
        "the unit of kurt2rt service install is permitted it; by hand: "
        f'echo "$USER - rtprio 50" | sudo tee -a {_LIMITS_FILE}, then log in again',
        "real-time priority",
    )
    CORES = ("cores", "{usable} usable of {cores}", "", "cores")
    CORES_FEW = (
        "cores few",
        "{usable} usable of {cores}: ticks share it with all else",
        "run the teacher's page and the simulator on another machine, or allow more cores (taskset, cpuset)",
        "cores",
    )
    GOVERNOR_NONE = (
        "governor none",
        "none to be read: a virtual machine, or a clock that is fixed",
        "",
        "CPU governor",
    )
    GOVERNOR = ("governor", "{governors}", "", "CPU governor")
    GOVERNOR_SAVING = (
        "governor saving",
        "{governors}",
        "echo performance | sudo tee {folder}/cpu*/cpufreq/scaling_governor",
        "CPU governor",
    )
    SQLITE_LOG = ("sqlite log", "write-ahead log works next to a reader", "", "SQLite log")
    SQLITE_LOG_FAILS = (
        "sqlite log fails",
        "does not work in this folder: {fault}",
        "give a folder on a local disk with --folder",
        "SQLite log",
    )
    FOLDER = ("folder", "{folder} can be written", "", "knowledge folder")
    FOLDER_TO_MAKE = (
        "folder to make",
        "{folder} is made when it is needed: {parent} can be written",
        "",
        "knowledge folder",
    )
    FOLDER_UNWRITABLE = (
        "folder unwritable",
        "{folder} cannot be written ({error})",
        _ANOTHER_FOLDER,
        "knowledge folder",
    )
    SPACE = ("space", "{free_gb:.1f} GB free", "", "free space")
    SPACE_LOW = ("space low", "{free_gb:.1f} GB free", f"make room, or {_ANOTHER_FOLDER}", "free space")
    SYNC = ("sync", _SYNC, "", "fsync")
    SYNC_SLOW = (
        "sync slow",
        f"{_SYNC}: above {{limit_ms:g}} ms, the teacher waits for each lesson",
        f"use a faster disk: {_ANOTHER_FOLDER}",
        "fsync",
    )
    CAN = ("can", "AF_CAN sockets can be opened", "", "CAN in the kernel")
    CAN_UNLOADED = ("can unloaded", "no AF_CAN socket ({error})", "sudo modprobe -a can can_raw", "CAN in the kernel")
    CAN_MISSING = ("can missing", "no AF_CAN socket ({error})", _OTHER_KERNEL, "CAN in the kernel")
    CAN_INTERFACE = ("can interface", "up", "", "CAN interface {name}")
    CAN_INTERFACE_NONE = (
        "can interface none",
        "none with hardware in {folder}",
        "plug in the adapter, then: {up}",
        "CAN interface",
    )
    CAN_INTERFACE_DOWN = ("can interface down", "down", "{up}", "CAN interface {name}")
    CAN_INTERFACE_OFF_BUS = (
        "can interface off bus",
        "up, but off the bus",
        "check cable, terminators and bit rate; sudo ip link set {name} down; {up}",
        "CAN interface {name}",
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
        return self.code.text.format(**self.values)

    @property
    def what_to_do(self) -> str:
        """Remedy, empty if there is nothing to do."""
        return self.code.do.format(**self.values)

    @property
    def forbids_run(self) -> bool:
        """True if `kurt2rt run` cannot start because of this."""
        return self.needed and self.status is CheckStatus.MISSING
