"""Weights of the features in a distance between situation and condition."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from hal.settings import SettingsError
from kurt2rt.core.perception.definition import SituationDefinition


def feature_weights(
    definition: SituationDefinition, changed: Iterable[tuple[Iterable[str], float]], past_weight: float, task: str
) -> NDArray[np.float64]:
    """Return the weights, shape (d,): 1 for recent features except `changed` ones, times `past_weight` for averages.

    Raises SettingsError, with the name of the `task`, for an unknown feature, for one with two weights, and if all
    weights are 0.
    """
    names = [feature.name for feature in definition.features]
    recent = dict.fromkeys(names, 1.0)
    seen: set[str] = set()
    for place, (features, weight) in enumerate(changed):
        key = f"task {task}: learning.weights.{place}.features"
        for name in features:
            if name not in recent:
                raise SettingsError(
                    f"situation {definition.name} has no feature {name!r}", where=key, do=f"it has: {', '.join(names)}"
                )
            if name in seen:
                raise SettingsError(f"{name!r} is given two weights", where=key, do="leave one out")
            seen.add(name)
            recent[name] = weight
    if not any(recent.values()):
        raise SettingsError("learning.weights: every feature weighs 0", where=f"task {task}", do="leave one with more")
    values = np.array([recent[name] for name in names])
    return np.concatenate((values, past_weight * values))
