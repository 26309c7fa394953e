"""Reduction of a laser scan to one distance per sector."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kurt2rt.ros.messages import Header, InvalidMessageError, LaserScan, to_time

Ranges = NDArray[np.float32]
_MOST_RANGES = 100_000
_CLOSE_FACTOR = 1.7
"""Multiples of the least range within which a thing may come too near before the next scan: 0.08 m at 0.4 m/s."""


class SectorReduction:
    """Nearest distance in each of several directions, by REP 117's meaning of invalid ranges."""

    def __init__(self, headings_deg: Sequence[float], *, zero_is_far: bool) -> None:
        """Give each ray to the heading that is nearest to it.

        Args:
            headings_deg: directions of the sectors' middles, counter-clockwise from the scanner's x axis.
            zero_is_far: whether a range of 0 means that nothing came back, as some drivers say; else it means nothing.
        """
        turned = np.asarray(headings_deg, dtype=np.float64) % 360
        self._order = np.argsort(turned)
        middles = turned[self._order]
        self._borders_deg = (middles + np.append(middles[1:], middles[0] + 360)) / 2
        """Upper border of each sector, in the order of their headings from 0; the last may lie beyond 360."""
        self._zero_is_far = zero_is_far
        self._last_m = np.full(len(turned), math.inf)
        self._layout: tuple[int, float, float] = (0, 0.0, 0.0)
        self._sector_of_ray = np.zeros(0, dtype=np.intp)

    def distances_m(self, scan: LaserScan) -> tuple[float, ...]:
        """Return a distance for each sector; infinite: nothing within range, NaN: no ray measured anything.

        If 0 means far, a sector that showed something close and then nothing shows the least distance, until it shows
        something again: the thing came too near to be measured. A thing that a turn took to another sector did not.
        A range below the scanner's least, or minus infinity, is an object too near to measure: it counts as the least.
        Raises kurt2rt.ros.messages.InvalidMessageError for a scan that makes no sense.
        """
        least_m, most_m = scan.range_min, scan.range_max
        if not (0 <= least_m < most_m < math.inf):
            raise InvalidMessageError(f"LaserScan: range_min {least_m:g} and range_max {most_m:g} make no sense")
        self._lay_out(len(scan.ranges), scan.angle_min, scan.angle_increment)
        with np.errstate(invalid="ignore"):  # a signalling NaN would have the tick print a warning
            ranges = scan.ranges.astype(np.float64)
            ranges[ranges == 0] = math.inf if self._zero_is_far else math.nan
            ranges[ranges > most_m] = math.inf
            ranges[ranges < least_m] = least_m
        nearest = np.full(len(self._order), math.nan)
        np.fmin.at(nearest, self._sector_of_ray, ranges)  # fmin passes over NaN
        if self._zero_is_far:
            nearest[self._vanished(nearest, least_m)] = least_m
            self._last_m = nearest
        return tuple(nearest.tolist())

    def _vanished(self, nearest_m: NDArray[np.float64], least_m: float) -> NDArray[np.bool_]:
        """Return the sectors, (sectors,), in which something close is no longer seen.

        A driver that sends 0 for nothing sends it for what is too near as well. What appears in that moment up to two
        sectors farther on was taken there by a turn.
        """
        was_close, is_close = (each[self._order] <= _CLOSE_FACTOR * least_m for each in (self._last_m, nearest_m))
        appeared = is_close & ~was_close
        turned_there = np.any([np.roll(appeared, shift) for shift in (-2, -1, 1, 2)], axis=0)
        vanished = np.zeros(len(nearest_m), dtype=np.bool_)
        vanished[self._order] = np.isinf(nearest_m[self._order]) & was_close & ~turned_there
        return vanished

    def _lay_out(self, number: int, first_rad: float, step_rad: float) -> None:
        """Find the sector of each ray, if the scan is of another layout than the previous one."""
        layout = (number, first_rad, step_rad)
        if layout == self._layout:
            return
        if not (0 < number <= _MOST_RANGES and math.isfinite(first_rad) and 0 < abs(step_rad) < math.tau):
            raise InvalidMessageError(
                f"LaserScan: {number} ranges from {first_rad:g} by {step_rad:g} rad make no sense"
            )
        rays_deg = np.degrees(first_rad + step_rad * np.arange(number)) % 360
        rays_deg[rays_deg < self._borders_deg[-1] - 360] += 360
        above = np.searchsorted(self._borders_deg, rays_deg, side="right")
        self._sector_of_ray = self._order[above % len(self._order)]
        self._layout = layout


def full_turn_scan(ranges_m: Ranges, limits_m: tuple[float, float], period_s: float, stamp_s: float) -> LaserScan:
    """Return the message of a scanner that turns once in `period_s`, in s, counter-clockwise from ahead.

    Args:
        ranges_m: ranges at equal angles, shape (rays,).
        limits_m: least and greatest range that it measures.
        stamp_s: time of the scan.
    """
    step_rad = math.tau / len(ranges_m)
    return LaserScan(
        header=Header(to_time(stamp_s), "base_scan"),
        angle_min=0.0,
        angle_max=step_rad * (len(ranges_m) - 1),
        angle_increment=step_rad,
        time_increment=0.0,
        scan_time=period_s,
        range_min=limits_m[0],
        range_max=limits_m[1],
        ranges=ranges_m,
        intensities=np.zeros(0, dtype=np.float32),
    )
