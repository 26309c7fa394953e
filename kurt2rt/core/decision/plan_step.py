"""How it stands with the goal, in one tick."""

from enum import StrEnum
from typing import NamedTuple


class GoalStatus(StrEnum):
    """How it stands with a goal."""

    NONE = "none"
    """There is none: the mid level commands as ever."""
    PLANNING = "planning"
    """A plan is being made, and has no wish yet; where the robot stood it stands, else the mid level commands."""
    UNDER_WAY = "under way"
    ARRIVED = "arrived"
    """The robot stands there."""
    NO_WAY = "no way"
    """From where it is nothing that it knows leads there, or the goal means nothing any more; the robot stands."""
    LOST = "lost"
    """It is at no place that it knows; the robot stands, and its mid level asks."""


class PlanStep(NamedTuple):
    """Where the robot is to go, and how."""

    goal: str
    """In words."""
    course: GoalStatus
    behaviours: tuple[str, ...]
    """Those that lead there, that of the way that is being gone first."""
    rla_id: int | None
    """The RLA of the mid level whose way is being gone; None while none is."""
    says: str
    """How it stands, in a line."""
    surprises: int
    """How often the robot came to another place than planned, since this goal was given."""
