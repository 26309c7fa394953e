"""Goal status that is reported with each tick."""

from enum import StrEnum
from typing import NamedTuple


class GoalStatus(StrEnum):
    """Status of the goal."""

    NONE = "none"
    """No goal; the mid level commands by its RLAs."""
    PLANNING = "planning"
    """A plan is being computed. The robot goes on as it did: it stands, or the mid level commands."""
    UNDER_WAY = "under way"
    ARRIVED = "arrived"
    """The robot stands at the goal."""
    NO_WAY = "no way"
    """No known way leads to the goal, or the goal does not exist now; the robot stands."""
    LOST = "lost"
    """The robot is at no known place; it stands, and its mid level asks."""


class PlanStep(NamedTuple):
    """Goal, status and next behaviours of one tick."""

    goal: str
    """Goal in words."""
    course: GoalStatus
    behaviours: tuple[str, ...]
    """Behaviours that lead to the goal, the present one first."""
    rla_id: int | None
    """Mid-level RLA whose way the robot drives; None between ways."""
    says: str
    """Status in one line."""
    surprises: int
    """Number of arrivals at another place than planned, since the goal was given."""
