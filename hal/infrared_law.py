"""Law of an infra-red distance sensor, as plain numbers."""

from typing import NamedTuple


class InfraredLawNumbers(NamedTuple):
    """Numbers of the law; distances in m from the sensor's face, readings in counts."""

    numerator_counts_m: float
    offset_m: float
    bias_counts: float
    near_m: float
    far_m: float
    floor_counts: float
    plateau_counts: float
    fold_back_from_m: float
    fold_back_counts_per_m: float
    fold_back_to_m: float


def counts_at(distance_m: float, law: InfraredLawNumbers) -> float:
    """Return the mean reading, fold-back and floor included, in counts (docs/the-robot.md#infra-red-law)."""
    if distance_m > law.far_m:
        return law.floor_counts
    if distance_m >= law.near_m:
        return law.numerator_counts_m / (distance_m + law.offset_m) - law.bias_counts
    if distance_m >= law.fold_back_from_m:
        return law.plateau_counts
    near_m = max(distance_m, law.fold_back_to_m)
    return law.plateau_counts - (law.fold_back_from_m - near_m) * law.fold_back_counts_per_m
