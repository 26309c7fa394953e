"""Result of a soak."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple

from kurt2rt.checks.faults.complaint import Complaint, Value
from kurt2rt.checks.soak.faults import FaultResult


class SoakMinute(NamedTuple):
    """Sums of one simulated minute."""

    at_s: float
    resident_mb: float
    open_files: int
    threads: int
    rlas: int
    lessons: int
    """Lessons in the knowledge file."""
    drives: float
    """Fraction of ticks with moving wheels."""
    asks: float
    stopped: float
    """Fraction of ticks in an alarm, a teacher's stop, or without a teacher."""
    worst_late_s: float
    """Largest lateness of a tick in simulated time."""
    missed_ticks: int
    mood: str
    """Mood of the teacher."""


class SoakStart(NamedTuple):
    """One start of the program."""

    at_s: float
    lasted_s: float
    wire: str
    ended_by: str
    """Error that ended it; empty for a requested end."""
    complaint: Complaint | None = None
    """Deviation of the knowledge file from the lessons."""
    left_mb: float = 0.0
    """Memory of live objects after the end; its growth is no knowledge."""


class CheckCode(StrEnum):
    """Property that must hold in a soak."""

    ENVELOPE = "envelope"
    FAULTS = "faults"
    STARTS = "starts"
    MEMORY = "memory"
    FILES_AND_THREADS = "files and threads"
    WAITING = "waiting"
    ODOMETRY = "odometry"
    RECORDED = "recorded"
    TEACHING_CLOCK = "teaching clock"


class SoakCheck(NamedTuple):
    """Result of one check with its numbers."""

    code: CheckCode
    passed: bool
    values: Mapping[str, Value]
    """Fields of the check's text."""
    judged: bool = True
    """False if the soak was too short to judge."""


@dataclass(frozen=True, slots=True)
class SoakResult:
    """Result of the whole soak."""

    name: str
    seed: int
    simulated_s: float
    took_s: float
    """Real time."""
    ticks: int
    missed_ticks: int
    frames: int
    """CONTROL frames checked against the envelope."""
    checks: tuple[SoakCheck, ...]
    minutes: tuple[SoakMinute, ...]
    starts: tuple[SoakStart, ...]
    faults: tuple[FaultResult, ...]
    complaints: tuple[Complaint, ...]
    """First complaints."""
    counted: dict[str, int]
    objects: dict[str, dict[str, int]] = field(default_factory=dict)
    """Numbers of objects by type and hour."""
    grown_kb: dict[str, float] = field(default_factory=dict)
    """Growth by module since the end of the first hour, if traced."""

    @property
    def passed(self) -> bool:
        """Return whether every check passed."""
        return all(check.passed for check in self.checks)
