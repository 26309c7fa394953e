"""Attribution of distances to features: shares of one distance, and the contrast of two RLAs."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kurt2rt.runs.explain.facts import LevelFacts, RlaFacts


@dataclass(frozen=True, slots=True)
class FeatureShare:
    """Share of one feature in the distance from a situation to an RLA's condition, with both values."""

    name: str
    here: float
    there: float
    """Value in the condition."""
    share: float
    """Share of the squared distance, 0 to 1; for symbols, of the places that differ."""


def distance_attribution(level: LevelFacts, rla: RlaFacts) -> tuple[FeatureShare, ...]:
    """Return all features that contribute to the distance, largest share first.

    Shares of the squared weighted distance from the situation of `level` to the condition of `rla`. Empty if the
    distance is 0 or not finite, as at a mid level that does not know its place.
    """
    squares = _squares(level, rla)
    whole = float(squares.sum())
    if not whole > 0 or not np.isfinite(whole):
        return ()
    order = np.argsort(-squares, kind="stable").tolist()
    return tuple(
        FeatureShare(level.names[place], level.vector[place], rla.condition[place], float(squares[place]) / whole)
        for place in order
        if squares[place] > 0
    )


def contrast_attribution(level: LevelFacts, first: RlaFacts, second: RlaFacts) -> dict[str, float]:
    """Return by feature its share of the summed absolute differences, -1 to 1; positive favours the first RLA."""
    difference = _squares(level, second) - _squares(level, first)
    whole = float(np.abs(difference).sum())
    if not whole > 0 or not np.isfinite(whole):
        return {}
    return dict(zip(level.names, (difference / whole).tolist(), strict=True))


def border_distance(level: LevelFacts, first: RlaFacts, second: RlaFacts) -> float | None:
    """Return the signed weighted distance from the situation to the border between two RLAs.

    The border is where both are equally near. None for symbols. Distances are dimensionless.
    """
    if not level.euclidean:
        return None
    weights = np.array(level.weights)
    apart = float(np.linalg.norm((np.array(first.condition) - np.array(second.condition)) * weights))
    if not apart > 0:
        return None
    return float(_squares(level, second).sum() - _squares(level, first).sum()) / (2 * apart)


def _squares(level: LevelFacts, rla: RlaFacts) -> NDArray[np.float64]:
    here, there = np.array(level.vector), np.array(rla.condition)
    if not level.euclidean:
        return np.array(here != there, dtype=np.float64)
    off: NDArray[np.float64] = (here - there) * np.array(level.weights)
    return off * off
