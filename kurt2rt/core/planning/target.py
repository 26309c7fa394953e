"""A goal as it can be compared with situations."""

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.decision.goal import Goal, NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.outcome import CommandRefusedError, RefusalCode
from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.rla import Rla

Vector = NDArray[np.float64]
Distance = Callable[[Vector, Vector], float]
"""How far two situations of the mid level are apart."""


GroupAt = Callable[[Vector], tuple[Rla, ...]]
"""The RLAs on the place that a situation of the mid level is at, oldest first; none where it is at no known one."""


class Target(Protocol):
    """What tells whether a situation is one that was to be reached."""

    def matches(self, situation: Vector) -> bool:
        """Whether a situation of the mid level is; never that of a robot that does not know where it is."""
        ...


class NearTarget:
    """All situations at the same place as one; where one of them is at no place that is known, near enough ones."""

    def __init__(self, situation: Condition, within: float, distance: Distance, group_at: GroupAt) -> None:
        """Good as long as the RLAs of the mid level stay as they are."""
        self._situation = np.array(situation, dtype=np.float64)
        self._within = within
        self._distance = distance
        self._group_at = group_at
        self._there = group_at(self._situation)

    def matches(self, situation: Vector) -> bool:
        """Whether a situation is."""
        if not np.isfinite(situation).all():
            return False
        here, there = self._group_at(situation), self._there
        if here and there:
            return here[0].rla_id == there[0].rla_id
        return self._distance(situation, self._situation) <= self._within


class FeatureTarget:
    """All situations with some features about as wanted."""

    def __init__(self, wanted: Mapping[int, float], tolerance: float) -> None:
        """`wanted`: values by the feature's place in the situation."""
        self._at = list(wanted)
        self._values = np.array(list(wanted.values()), dtype=np.float64)
        self._tolerance = tolerance

    def matches(self, situation: Vector) -> bool:
        """Whether all of them are."""
        if not np.isfinite(situation).all():
            return False
        return bool((np.abs(situation[self._at] - self._values) <= self._tolerance).all())


def make_target(
    goal: Goal,
    *,
    named: Mapping[str, Condition],
    rla: Callable[[int], Rla | None],
    level: str,
    features: Sequence[str],
    radius: float,
    distance: Distance,
    group_at: GroupAt,
) -> Target:
    """Return what a goal means now. Raises CommandRefusedError, which lists the goals that there are.

    `named`: situations of that level by name; `rla`: the living RLA of an id; `radius`: what counts as near.
    """
    match goal:
        case NamedGoal(name):
            if name not in named:
                raise CommandRefusedError(RefusalCode.NOT_NAMED, name=name, known=tuple(sorted(named)))
            return NearTarget(named[name], radius, distance, group_at)
        case RlaGoal(rla_id):
            meant = rla(rla_id)
            if meant is None or meant.level != level:
                raise CommandRefusedError(RefusalCode.NO_RLA, rla=rla_id)
            return NearTarget(meant.condition, radius if meant.radius is None else meant.radius, distance, group_at)
        case PartialGoal(wanted, tolerance):
            unknown = sorted(name for name, _ in wanted if name not in features)
            if unknown or not wanted:
                raise CommandRefusedError(
                    RefusalCode.NO_FEATURE, features=tuple(unknown), level=level, known=tuple(features)
                )
            return FeatureTarget({features.index(name): value for name, value in wanted}, tolerance)
