"""Verdict on one number of a study: the target, the measured value, and whether it is met."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum


class Target(StrEnum):
    """Number that a study has to reach."""

    RLAS = "rlas"
    TEACHING = "teaching"
    SUCCESS = "success"
    JUNCTIONS_RIGHT = "junctions right"
    COLLISIONS = "collisions"
    REPAIRED_BY_REWARDS = "repaired by rewards"
    REPAIRED_BY_CRITIC = "repaired by critic"
    NEGATIVE_REWARDS = "negative rewards"
    FEWER_COLLISIONS = "fewer collisions"
    INTACT_STAYS_CLEAN = "intact stays clean"
    INTACT_NOT_WORSE = "intact not worse"
    INTERVENTIONS = "interventions"
    MID_RLAS = "mid rlas"
    DECISIONS_RIGHT = "decisions right"
    WITHOUT_ERROR = "without error"
    RIGHT_IN_NEW_WORLD = "right in new world"
    PRESSES_UNTIL_RIGHT = "presses until right"
    RIGHT_AT_HOME = "right at home"


class Result(StrEnum):
    """Result of a verdict."""

    MET = "met"
    MISSED = "missed"
    NOT_JUDGED = "not judged"


Values = Mapping[str, float | str]


@dataclass(frozen=True, slots=True)
class Verdict:
    """Target and measured value."""

    target: Target
    values: Values
    """Fields of the target's texts."""
    met: bool
    judged: bool = True
    """False: there is nothing to judge by."""

    @property
    def result(self) -> Result:
        """Result of the comparison: met, missed or not judged."""
        if not self.judged:
            return Result.NOT_JUDGED
        return Result.MET if self.met else Result.MISSED
