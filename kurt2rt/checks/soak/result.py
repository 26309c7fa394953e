"""What a soak came to."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple

from kurt2rt.checks.faults.complaint import Complaint, Value
from kurt2rt.checks.soak.faults import FaultResult


class SoakMinute(NamedTuple):
    """A minute of simulated time, as it was at its end."""

    at_s: float
    resident_mb: float
    open_files: int
    threads: int
    rlas: int
    lessons: int
    """Of all of the knowledge file so far."""
    drives: float
    """Share of its ticks in which the wheels were told to turn."""
    asks: float
    stopped: float
    """Share in which the robot stood for good: an alarm, a teacher's stop, or nobody there."""
    worst_late_s: float
    """Of its ticks, against their deadlines, in simulated time."""
    missed_ticks: int
    mood: str
    """Of the teacher."""


class SoakStart(NamedTuple):
    """One start of the program."""

    at_s: float
    lasted_s: float
    wire: str
    ended_by: str
    """The error that ended it; empty where it was told to."""
    complaint: Complaint | None = None
    """What was wrong with the knowledge file that it left."""
    left_mb: float = 0.0
    """What objects took when it was over, with all that it knew: what grows here is no knowledge."""


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
    """Whether a property held, with the numbers that were measured."""

    code: CheckCode
    passed: bool
    values: Mapping[str, Value]
    """Fields of the check's text."""
    judged: bool = True
    """False if the soak was too short to judge."""


@dataclass(frozen=True, slots=True)
class SoakResult:
    """All of it."""

    name: str
    seed: int
    simulated_s: float
    took_s: float
    """Real time."""
    ticks: int
    missed_ticks: int
    frames: int
    """CONTROL frames that were held against the envelope."""
    checks: tuple[SoakCheck, ...]
    minutes: tuple[SoakMinute, ...]
    starts: tuple[SoakStart, ...]
    faults: tuple[FaultResult, ...]
    complaints: tuple[Complaint, ...]
    """The first ones."""
    counted: dict[str, int]
    objects: dict[str, dict[str, int]] = field(default_factory=dict)
    """How many objects of which types there were, by the hour."""
    grown_kb: dict[str, float] = field(default_factory=dict)
    """By module, since the end of the first hour, where that was asked for."""

    @property
    def passed(self) -> bool:
        """Whether everything held."""
        return all(check.passed for check in self.checks)
