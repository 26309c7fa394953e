"""Goals that a teacher can send the robot to, and their texts."""

from collections.abc import Mapping
from dataclasses import dataclass

from kurt2rt.core.decision.decision import GoalStatus


@dataclass(frozen=True, slots=True)
class NamedGoal:
    """Goal given by the name of a situation, such as "door", which a teacher named before."""

    name: str

    @property
    def text(self) -> str:
        """Goal in words: the name of the situation."""
        return self.name


@dataclass(frozen=True, slots=True)
class RlaGoal:
    """Goal given by an RLA: the mid-level situation that is its condition."""

    rla_id: int

    @property
    def text(self) -> str:
        """Goal in words, such as `the situation of RLA 12`."""
        return f"the situation of RLA {self.rla_id}"


@dataclass(frozen=True, slots=True)
class PartialGoal:
    """Any situation with the given values of some features, such as a wall on the left."""

    features: tuple[tuple[str, float], ...]
    """Names of mid-level features and their wanted values."""
    tolerance: float = 0.0
    """Largest difference of each value, in the feature's unit."""

    @property
    def text(self) -> str:
        """Goal in words: its features and values."""
        return " and ".join(f"{name} {value:g}" for name, value in self.features)


Goal = NamedGoal | RlaGoal | PartialGoal
"""Situation of the mid level that the robot is sent to: by name, by an RLA, or by the values of some features.

`Seek` carries one; `Navigator` plans to it, and the robot stands there. For example NamedGoal("door").
"""


_TEXTS: Mapping[str, str] = {
    GoalStatus.ARRIVED: "arrived: {goal}",
    GoalStatus.PLANNING: "planning the way to {goal}",
    GoalStatus.NO_WAY: "no way from here to {goal}: nothing taught leads there",
    GoalStatus.LOST: "lost on the way to {goal}: this place is not known; answer here, or set it down",
    GoalStatus.UNDER_WAY: "on the way to {goal}: the plan begins behind the next junction",
}


def goal_text(status: str, goal: str) -> str:
    """Return a line for a teacher: a goal's text with its status.

    `status`: value of GoalStatus. `goal`: text of the goal.
    """
    return _TEXTS[status].format(goal=goal)
