"""Neighbours of each infra-red sensor, and a reading instead of a broken sensor's."""

import math
from collections.abc import Collection, Sequence
from typing import NamedTuple

from hal.numerics import cos_sin
from hal.robot_settings import InfraredSettings, SensorSettings


class Neighbours(NamedTuple):
    """Sensors next to one sensor, by their places in the sensor table."""

    before: int
    """Next sensor clockwise round the robot."""
    after: int
    """Next sensor counter-clockwise."""
    second_before: int
    """Sensor next to `before`, clockwise."""
    second_after: int
    """Sensor next to `after`, counter-clockwise."""
    substitutes: tuple[int, ...]
    """Sensors whose readings replace this sensor's: those next to it that look the same way, or else both."""
    has_witnesses: bool
    """True if both sensors next to it look nearly the same way: then their readings say something about its own."""


WITNESS_DEG = 60.0
"""Greatest angle between two sensors that look nearly the same way. KURT2's are 45 degrees apart at most; a robot with
few sensors has gaps."""


def neighbours_of(sensors: Sequence[SensorSettings]) -> tuple[Neighbours, ...]:
    """Return the neighbours of each sensor, in the order of the table, as indexes into it.

    The ring goes by heading, and among sensors of one heading by their place along the side.
    """
    ring = sorted(range(len(sensors)), key=lambda place: _ring_key(sensors[place]))
    found: dict[int, Neighbours] = {}
    for at, place in enumerate(ring):
        before, after, second_before, second_after = (ring[(at + step) % len(ring)] for step in (-1, 1, -2, 2))
        alike = tuple(each for each in (before, after) if sensors[each].heading_deg == sensors[place].heading_deg)
        has_witnesses = all(
            abs(math.remainder(sensors[each].heading_deg - sensors[place].heading_deg, 360.0)) <= WITNESS_DEG
            for each in (before, after)
        )
        found[place] = Neighbours(before, after, second_before, second_after, alike or (before, after), has_witnesses)
    return tuple(found[place] for place in range(len(sensors)))


def _ring_key(sensor: SensorSettings) -> tuple[float, float]:
    """Return the sorting key of a sensor: its heading, then its place to the left of that heading, in m."""
    cos, sin = cos_sin(math.radians(sensor.heading_deg))
    return sensor.heading_deg % 360.0, sensor.y_m * cos - sensor.x_m * sin


class SubstituteReadings:
    """Function that replaces the readings of broken sensors by those of the sensors next to them.

    The highest (nearest) of the working neighbours counts. The tick applies it after `SensorWatch` found a fault, so
    that the robot can go on after a resume.
    """

    def __init__(self, infrared: InfraredSettings) -> None:
        self._neighbours = neighbours_of(infrared.sensors)
        self._near_counts = infrared.plateau_counts

    def __call__(self, counts: tuple[int, ...], broken: Collection[int]) -> tuple[int, ...]:
        """Return the counts, one per sensor, with the highest of the neighbours instead of each broken sensor.

        For a sensor without a working neighbour an obstacle right in front of it is assumed, so that the robot turns
        away or asks.
        """
        if not broken:
            return counts
        trusted = list(counts)
        for place in broken:
            working = [counts[each] for each in self._neighbours[place].substitutes if each not in broken]
            trusted[place] = max(working, default=self._near_counts)
        return tuple(trusted)
