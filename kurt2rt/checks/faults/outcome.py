"""Outcome of a fault scenario."""

from dataclasses import dataclass, field
from typing import NamedTuple

from kurt2rt.checks.faults.complaint import Complaint
from kurt2rt.checks.faults.table import Kind, Target

LOST_FRAMES = "lost frames"
"""Key in `FaultOutcome.counted` for frames missing in the CAN log."""


class Standstill(NamedTuple):
    """Standstill of the robot by the commands on its end of the bus."""

    after_s: float
    because: tuple[str, ...]
    """Causes in the driver's first tick from then on that commanded a standstill."""


@dataclass(frozen=True, slots=True)
class FaultOutcome:
    """Outcome of one fault; times count from its beginning."""

    target: Target
    kind: Kind
    seed: int
    first: Standstill | None
    """First standstill during the fault; None without one."""
    last: Standstill | None
    """Standstill that lasted to the end of the fault; None if the robot drove then."""
    went_on: bool
    """True if it drove again during the fault after a standstill."""
    longest_stand_s: float
    """Longest standstill during the fault."""
    latched: str | None
    """Guard's latch reason at the end of the fault; None without a latch."""
    latched_after_s: float | None
    ended_by: str
    """Error that ended the service; empty without one."""
    drove_by_itself: bool
    """True if it drove after the fault without a command of a teacher."""
    drove_when_told: bool
    """True if it drove in the end."""
    oldest_age_s: float
    """Largest age of a moving command when it was put on the bus."""
    old_frames: int
    """Set points that exceeded the age limit on arrival at the robot."""
    frames: int
    """CONTROL frames of the driver."""
    counted: dict[str, int]
    """Numbers of lost, refused and garbled messages."""
    problems: tuple[Complaint, ...] = field(default=())
    """Violations of the envelope, lost lessons and miscounted frames."""
