"""The robot's question: "I don't know this situation, teach me"."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kurt2rt.rla.rla import ASK, rla_title
from kurt2rt.rla.rla_system import Match


@dataclass(frozen=True, slots=True)
class FeatureDifference:
    """One feature in which the situation differs from the nearest RLA's condition."""

    name: str
    here: float
    in_condition: float


@dataclass(frozen=True, slots=True)
class Question:
    """What the teacher sees when the robot asks."""

    nearest_rla: int | None
    """None before the first lesson."""
    action: str | None
    """What the nearest RLA would do."""
    distance: float
    radius: float
    differing: tuple[FeatureDifference, ...]
    """The features that differ most, most first."""
    behaviour: str = ""
    """The taught behaviour that is wanted; empty where the task has only one."""

    def __str__(self) -> str:
        if self.nearest_rla is None:
            of = f" of {self.behaviour}" if self.behaviour else ""
            return f"I know nothing{of} yet, teach me"
        features = ", ".join(f"{each.name} {each.here:.0f} not {each.in_condition:.0f}" for each in self.differing)
        nearest = rla_title(self.nearest_rla, self.behaviour)
        action = "its action was withdrawn" if self.action == ASK else self.action
        return (
            f"I don't know this situation, teach me: nearest is {nearest} ({action}) "
            f"at {self.distance:.0f} of {self.radius:.0f}; {features}"
        )


def ask(
    match: Match | None,
    situation: NDArray[np.float64],
    weights: NDArray[np.float64],
    feature_names: tuple[str, ...],
    behaviour: str = "",
    most: int = 5,
) -> Question:
    """Question about a situation vector (d,) whose nearest RLA of `behaviour` is `match`, found with `weights` (d,)."""
    if match is None:
        return Question(None, None, float("inf"), 0.0, (), behaviour)
    condition = np.array(match.rla.condition)
    differences = np.abs(situation - condition) * weights
    order = np.argsort(-differences, kind="stable")[:most]
    differing = tuple(
        FeatureDifference(feature_names[i], float(situation[i]), float(condition[i]))
        for i in order
        if differences[i] > 0.0
    )
    return Question(match.rla.rla_id, match.rla.action, match.distance, match.radius, differing, behaviour)
