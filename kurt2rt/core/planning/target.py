"""Targets: goals as predicates on mid-level situations."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.decision.goal import Goal, NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.outcome import CommandRefusedError, RefusalCode
from kurt2rt.core.rla.condition import Condition, Space
from kurt2rt.core.rla.matching import exact_distances, hamming_distances
from kurt2rt.core.rla.rla import MID, Rla
from kurt2rt.core.rla.rla_system import RlaSystem

Vector = NDArray[np.float64]
Distance = Callable[[Vector, Vector], float]
"""Distance of two mid-level situations (d,)."""

GroupAt = Callable[[Vector], tuple[Rla, ...]]
"""Function from a situation (d,) to the RLAs on its place, oldest first; empty at an unknown place."""

Target = Callable[[Vector], bool]
"""Function from a situation (d,) to whether it reaches a goal; False for a lost robot (NaN)."""


def near_target(situation: Condition, within: float, distance: Distance, group_at: GroupAt) -> Target:
    """Return the target that is the place of a situation, or its neighbourhood if one of the two places is unknown.

    It is valid until the mid-level RLAs change. `within`: greatest distance, in m or symbols, if a place is unknown.
    """
    wanted = np.array(situation, dtype=np.float64)
    there = group_at(wanted)

    def reached(vector: Vector) -> bool:
        if not np.isfinite(vector).all():
            return False
        here = group_at(vector)
        if here and there:
            return here[0].rla_id == there[0].rla_id
        return distance(vector, wanted) <= within

    return reached


def feature_target(wanted: Mapping[int, float], tolerance: float) -> Target:
    """Return the target of all situations near to some values, such as a position.

    `wanted`: index of the feature -> value; `tolerance`: in the unit of the features, such as m.
    """
    at, values = list(wanted), np.array(list(wanted.values()), dtype=np.float64)

    def reached(vector: Vector) -> bool:
        return bool(np.isfinite(vector).all() and (np.abs(vector[at] - values) <= tolerance).all())

    return reached


def make_target(
    goal: Goal, system: RlaSystem, features: Sequence[str], space: Space, distance: Distance, group_at: GroupAt
) -> Target:
    """Return the target of a goal. Raises CommandRefusedError, with the existing goals, for an unknown one.

    Args:
        goal: goal of the mid level.
        system: knowledge that the goal refers to.
        features: names of the mid-level features.
        space: space of the mid level; its radius is the neighbourhood of a place.
        distance: distance function of `space`.
        group_at: RLAs on the place of a situation.
    """
    radius = space.radius
    match goal:
        case NamedGoal(name):
            named = system.named_situations(MID)
            if name not in named:
                raise CommandRefusedError(RefusalCode.NOT_NAMED, name=name, known=tuple(sorted(named)))
            return near_target(named[name], radius, distance, group_at)
        case RlaGoal(rla_id):
            rla = system.get(rla_id)
            if rla is None or rla.level != MID:
                raise CommandRefusedError(RefusalCode.NO_RLA, rla=rla_id)
            return near_target(rla.condition, radius if rla.radius is None else rla.radius, distance, group_at)
        case PartialGoal(wanted, tolerance):
            unknown = sorted(name for name, _ in wanted if name not in features)
            if unknown or not wanted:
                raise CommandRefusedError(
                    RefusalCode.NO_FEATURE, features=tuple(unknown), level=MID, known=tuple(features)
                )
            return feature_target({features.index(name): value for name, value in wanted}, tolerance)


def distance_function(space: Space) -> Distance:
    """Return the distance function of two situations (d,) in a space."""
    if space.metric == "hamming":
        return lambda a, b: float(hamming_distances(a[np.newaxis], b)[0])
    weights: Vector = np.ones(space.dimensions) if space.weights is None else space.weights
    return lambda a, b: float(exact_distances((a * weights)[np.newaxis], b * weights)[0])
