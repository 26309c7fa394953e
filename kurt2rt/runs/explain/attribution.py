"""Which features made a distance what it is, and which spoke for one RLA against another."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kurt2rt.runs.explain.facts import LevelFacts, RlaFacts


@dataclass(frozen=True, slots=True)
class FeatureShare:
    """One feature beside that of a condition."""

    name: str
    here: float
    there: float
    """In the condition."""
    share: float
    """Of the squared distance, 0 to 1; of symbols, of the places that differ."""


@dataclass(frozen=True, slots=True)
class FeatureContrast:
    """What one feature says of two RLAs."""

    name: str
    here: float
    in_first: float
    in_second: float
    pull: float
    """For the first one where it is positive: its part of all that speaks for one or the other, -1 to 1."""


def distance_attribution(level: LevelFacts, rla: RlaFacts) -> tuple[FeatureShare, ...]:
    """All features that differ and count, most first; empty where the robot does not know where it is."""
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


def contrast_attribution(level: LevelFacts, first: RlaFacts, second: RlaFacts) -> tuple[FeatureContrast, ...]:
    """All features that speak for one of the two, loudest first."""
    difference = _squares(level, second) - _squares(level, first)
    whole = float(np.abs(difference).sum())
    if not whole > 0 or not np.isfinite(whole):
        return ()
    order = np.argsort(-np.abs(difference), kind="stable").tolist()
    return tuple(
        FeatureContrast(
            level.names[place],
            level.vector[place],
            first.condition[place],
            second.condition[place],
            float(difference[place]) / whole,
        )
        for place in order
        if difference[place] != 0
    )


def border_distance(level: LevelFacts, first: RlaFacts, second: RlaFacts) -> float | None:
    """How far the situation lies from where both are equally near, weighted as a distance; None of symbols."""
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
