"""What a drill came to."""

from dataclasses import dataclass, field
from typing import NamedTuple

from kurt2rt.checks.faults.complaint import Complaint
from kurt2rt.checks.faults.table import Kind, Target

LOST_FRAMES = "lost frames"
"""In `FaultOutcome.counted`: those that are not in the CAN log."""


class Standstill(NamedTuple):
    """The robot's end of the bus knows nothing but to stand."""

    after_s: float
    because: tuple[str, ...]
    """The driver's words in the first tick from then on in which it told the robot to stand."""


@dataclass(frozen=True, slots=True)
class FaultOutcome:
    """One fault, once. Times count from the fault's beginning."""

    target: Target
    kind: Kind
    seed: int
    first: Standstill | None
    """The first one during the fault; None when it never stood."""
    last: Standstill | None
    """The one that lasted until the fault was over; None when it drove then."""
    went_on: bool
    """Whether it drove again during the fault after it had stood."""
    longest_stand_s: float
    """During the fault."""
    latched: str | None
    """Why it was stopped for good when the fault was over, in the guard's word; None when it was not."""
    latched_after_s: float | None
    ended_by: str
    """The error that ended the service; empty when none did."""
    drove_by_itself: bool
    """Whether it drove when the fault was over, before anybody said anything."""
    drove_when_told: bool
    """Whether it drove in the end."""
    oldest_age_s: float
    """Of the commands that moved the robot, when they were put on the bus."""
    old_frames: int
    """Set points that were older than allowed when they arrived at the robot."""
    frames: int
    """CONTROL frames that the driver sent."""
    counted: dict[str, int]
    """What was lost, refused or not understood."""
    problems: tuple[Complaint, ...] = field(default=())
    """Everything beyond the envelope, and what went wrong beside the robot's motion."""
