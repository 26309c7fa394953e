"""Fit of the infra-red calibration, counts = numerator / (distance + offset) - bias."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from config.errors import UserError
from kurt2rt.checks.commission.fault import FaultCode, Field, StepFault

LEAST_DISTANCES = 4
_OFFSETS_M = np.linspace(0.005, 0.12, 231)
_SIGMA_COUNTS, _SIGMA_SHARE = 2.5, 0.03
"""Standard deviation of a reading: a hand-held ruler (3 mm are 2 to 3 %) and the spread of sensors."""
_OUTLIER_SIGMAS = 4.0
_OUTLIERS_AT_MOST = 4
"""Readings per allowed outlier."""
_WORST_SCATTER = 2.0
_BIASES = (0.0, 250.0)
_NEAR_M, _FAR_M = 0.10, 0.60
_NEAR_COUNTS, _FAR_COUNTS = (250.0, 1000.0), (0.0, 250.0)
_LEAST_RATIO = 2.5


class IrCalibrationError(UserError, ValueError):
    """Readings at known distances to which no calibration fits; `fault` tells the reason."""

    def __init__(self, code: FaultCode, **fields: Field) -> None:
        """Word the fault."""
        self.fault = StepFault(code, fields)
        super().__init__(self.fault.text)


class IrReading(NamedTuple):
    """Measurement for the calibration: median counts of a sensor with a board at a distance from its face."""

    sensor: str
    distance_m: float
    counts: float


@dataclass(frozen=True, slots=True)
class IrLaw:
    """Calibration of the infra-red sensors: counts from distances in m and back."""

    numerator_counts_m: float
    offset_m: float
    bias_counts: float

    def counts_at(self, distance_m: float) -> float:
        """Return the reading in counts at a distance in m from the sensor's face."""
        return self.numerator_counts_m / (distance_m + self.offset_m) - self.bias_counts

    def distance_m(self, counts: float) -> float:
        """Return the distance in m of a reading in counts."""
        return self.numerator_counts_m / (counts + self.bias_counts) - self.offset_m


@dataclass(frozen=True, slots=True)
class IrFit:
    """Calibration fitted by `fit_law`, with the residual of each reading and the readings left out."""

    law: IrLaw
    residuals: tuple[float, ...]
    """Counts, reading minus fit, in the order of the readings."""
    outliers: tuple[int, ...]
    """Indices of readings left out of the fit."""
    scatter: float
    """Root mean square of the other residuals in units of the standard deviation."""


def fit_law(readings: Sequence[IrReading]) -> IrFit:
    """Return the fit of the law to readings by least squares, without single outliers.

    Raises IrCalibrationError if there are too few readings, or no law fits them.
    """
    _require_range(readings)
    kept = list(range(len(readings)))
    fit = _fit(readings, kept)
    while fit.scatter > 1.0 and len(readings) - len(kept) < len(readings) // _OUTLIERS_AT_MOST:
        # The one whose absence mends most; the farthest from a fit that it bent itself need not be it.
        without = {at: _fit(readings, [each for each in kept if each != at]) for at in kept}
        worst = min(without, key=lambda at: without[at].scatter)
        off = abs(without[worst].residuals[worst]) / _sigma(readings[worst].counts)
        if off < _OUTLIER_SIGMAS:
            break
        kept.remove(worst)
        fit = without[worst]
    _require_plausible(fit)
    return fit


def _fit(readings: Sequence[IrReading], kept: Sequence[int]) -> IrFit:
    """Fit a line in 1 / (distance + offset) for each offset, and take the best offset."""
    distances = np.array([readings[at].distance_m for at in kept])
    counts = np.array([readings[at].counts for at in kept])
    weights = np.array([_sigma(value) ** -2 for value in counts])
    x = 1.0 / (distances + _OFFSETS_M[:, None])
    total = weights.sum()
    mean_x, mean_counts = (x @ weights / total)[:, None], counts @ weights / total
    slope = ((x - mean_x) * weights) @ (counts - mean_counts) / (((x - mean_x) ** 2) @ weights)
    bias = slope * mean_x[:, 0] - mean_counts
    # A law with a bias outside of its range is pulled to the edge, and its slope with it.
    bias = np.clip(bias, *_BIASES)
    slope = (x @ (weights * counts) + bias * (x @ weights)) / (x**2 @ weights)
    cost = ((counts - (slope[:, None] * x - bias[:, None])) ** 2) @ weights
    best = int(np.argmin(cost))
    law = IrLaw(float(slope[best]), float(_OFFSETS_M[best]), float(bias[best]))
    residuals = tuple(each.counts - law.counts_at(each.distance_m) for each in readings)
    scatter = float(np.sqrt(cost[best] / len(kept)))
    return IrFit(law, residuals, tuple(at for at in range(len(readings)) if at not in kept), scatter)


def _sigma(counts: float) -> float:
    return float(np.hypot(_SIGMA_COUNTS, _SIGMA_SHARE * counts))


def _require_range(readings: Sequence[IrReading]) -> None:
    distances = [each.distance_m for each in readings]
    if len(set(distances)) < LEAST_DISTANCES or min(distances) > 0.15 or max(distances) < 0.4:
        raise IrCalibrationError(FaultCode.LAW_DISTANCES, least=LEAST_DISTANCES)
    near, far = (
        float(np.median([each.counts for each in readings if each.distance_m == end(distances)])) for end in (min, max)
    )
    if near < _LEAST_RATIO * far:
        raise IrCalibrationError(
            FaultCode.LAW_FLAT, near_counts=near, near_m=min(distances), far_counts=far, far_m=max(distances)
        )


def _require_plausible(fit: IrFit) -> None:
    near, far = fit.law.counts_at(_NEAR_M), fit.law.counts_at(_FAR_M)
    if fit.scatter > _WORST_SCATTER:
        raise IrCalibrationError(FaultCode.LAW_SCATTER)
    for distance_m, counts, (least, most) in ((_NEAR_M, near, _NEAR_COUNTS), (_FAR_M, far, _FAR_COUNTS)):
        if not least <= counts <= most:
            raise IrCalibrationError(
                FaultCode.LAW_IMPLAUSIBLE,
                counts=counts,
                distance_m=distance_m,
                least_counts=least,
                most_counts=most,
            )
