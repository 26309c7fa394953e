"""Result of one check of the machine: a code with its numbers; kurt2rt.checks.doctor.finding_text has the texts."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum


class CheckStatus(StrEnum):
    """Suitability of the machine in one respect: ok, a warning, or missing."""

    OK = "ok"
    WARNING = "warning"
    MISSING = "missing"


class FindingCode(StrEnum):
    """State of the machine in one respect."""

    PYTHON = "python"
    PYTHON_OLD = "python old"
    PACKAGE = "package"
    PACKAGE_MISSING = "package missing"
    TIMER = "timer"
    TIMER_LATE = "timer late"
    TIMER_MISSING = "timer missing"
    CLOCK = "clock"
    CLOCK_COARSE = "clock coarse"
    CLOCK_SLOW = "clock slow"
    PRIORITY = "priority"
    PRIORITY_REFUSED = "priority refused"
    MEMORY_LOCK_UNLIMITED = "memory lock unlimited"
    MEMORY_LOCK_CAPABLE = "memory lock capable"
    MEMORY_LOCK_LARGE = "memory lock large"
    MEMORY_LOCK_SMALL = "memory lock small"
    CORES = "cores"
    CORES_FEW = "cores few"
    GOVERNOR_NONE = "governor none"
    GOVERNOR = "governor"
    GOVERNOR_SAVING = "governor saving"
    BLAS = "blas"
    BLAS_MANY = "blas many"
    SQLITE = "sqlite"
    SQLITE_OLD = "sqlite old"
    SQLITE_LOG = "sqlite log"
    SQLITE_LOG_FAILS = "sqlite log fails"
    FOLDER = "folder"
    FOLDER_TO_MAKE = "folder to make"
    FOLDER_UNWRITABLE = "folder unwritable"
    SPACE = "space"
    SPACE_LOW = "space low"
    SYNC = "sync"
    SYNC_SLOW = "sync slow"
    CAN = "can"
    CAN_UNLOADED = "can unloaded"
    CAN_MISSING = "can missing"
    CAN_INTERFACE = "can interface"
    CAN_INTERFACE_NONE = "can interface none"
    CAN_INTERFACE_DOWN = "can interface down"
    CAN_INTERFACE_OFF_BUS = "can interface off bus"
    VCAN = "vcan"
    VCAN_DOWN = "vcan down"
    VCAN_NONE = "vcan none"
    VCAN_NO_MODULE = "vcan no module"


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
    def forbids_run(self) -> bool:
        """True if `kurt2rt run` cannot start because of this."""
        return self.needed and self.status is CheckStatus.MISSING
