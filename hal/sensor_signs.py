"""Signs that one infra-red sensor is broken: dead, stuck, unplugged, dark or seeing a phantom.

The functions over counters are shared with the compiled loops of a batch, which keep them in arrays.
"""

import math
from collections.abc import Container, MutableSequence
from enum import StrEnum
from typing import NamedTuple

from hal.odometry import WheelMotion
from hal.robot_settings import InfraredSettings, RobotSettings
from hal.sensor_ring import Neighbours


class SensorFault(StrEnum):
    """Code for the sign by which a broken sensor was noticed."""

    STUCK = "stuck"
    """It repeats its reading while the others flicker."""
    OUT_OF_RANGE = "out of range"
    """It reads less or more than a working sensor does."""
    SEES_NOTHING = "sees nothing"
    """It stays low while both neighbours see something near."""
    SEES_A_PHANTOM = "sees a phantom"
    """It stays high while both neighbours see nothing near, and does not follow their changes."""


LOOK_TICKS = 5
"""Ticks between two looks at all sensors: each look meets new measurements, because a sensor measures every 29 to 48 ms
(docs/the-robot.md#noise-and-timing). All at once take 3.5 µs a tick on average; a quarter of them in each tick took
4.9 µs, because their code and data had left the caches."""
STUCK_TIMES = 4
"""Times `frozen_infrared_s`, of driving within STUCK_BAND, until a sensor is stuck: 4 s are 80 measurements.

A working sensor takes 68 % of its measurements there with nothing in view; healthy drives had at most 1.4 s.
"""
STUCK_BAND = 2
"""Width in counts: a converter's last bit flickers also with a constant voltage."""
FLICKERS_TICKS = 100
"""Ticks of driving within STUCK_BAND up to which another sensor counts as flickering."""
RANGE_TICKS = 50
"""Ticks out of range before a sensor is broken."""
LOWEST, HIGHEST = 0.6, 1.2
"""Range of a working sensor, in floor and plateau counts; gain and noise take 7 and 12 % of it."""
QUIET_COUNTS, QUIET_RATIO = 12, 0.16
"""Width of the band that noise alone explains, in counts and as a ratio of the reading: 8 standard deviations."""
DIFFERS_COUNTS = 60
"""Difference to both neighbours that contradicts them."""
DARK_TICKS = 150
"""Ticks of driving in such a contradiction. A sensor that looks through a door next to its neighbours' walls had nine
false alarms with 90 in 160 minutes of flats, three with 120, none with 150."""
DARK_DIFFERS_COUNTS = 40
"""Difference to both neighbours that contradicts a dark sensor: they see something within 0.44 m."""
AGREES_COUNTS = 30
"""Difference to a dark sensor from which on the sensors next to its neighbours bear the neighbours out."""
PHANTOM_TICKS = 450
"""Ticks of driving in the opposite contradiction, which a thin post explains for long."""
SWING_COUNTS = 100
"""Counts by which both neighbours must have changed meanwhile: a neighbour that is stuck is no witness."""
PASSES_M = 0.4
"""Way of the wheels past an obstacle that two sensors on each side do not see: it is narrower than the gap between
them. On a circle round a post the way is 0."""
KEEPS = 0.985
"""Part of that way that is kept from look to look, half after 2.3 s: slip and an unsure distance do not add up."""


_DARK_RATIO = 0.9
"""Highest reading of a dark sensor, as a ratio of the reading right before a wall, where the law folds back."""
_DIGITS = 12
"""Sine and cosine differ in their last digits between platforms, and a replay compares bit for bit."""


class Beam(NamedTuple):
    """Direction and place of a range sensor, as its beam sees them."""

    sine: float
    """Sine of its heading."""
    cosine: float
    along_m: float
    """Place of the sensor along its beam, from the robot's centre, in m."""
    aside_m: float
    """Place of the sensor across its beam, to the left, in m."""


def beam_of(infrared: InfraredSettings, place: int) -> Beam:
    """Return the beam of the sensor at `place` of the sensor table."""
    sensor = infrared.sensors[place]
    heading_rad = math.radians(sensor.heading_deg)
    sine, cosine = round(math.sin(heading_rad), _DIGITS), round(math.cos(heading_rad), _DIGITS)
    return Beam(sine, cosine, sensor.x_m * cosine + sensor.y_m * sine, sensor.y_m * cosine - sensor.x_m * sine)


class SensorLimits(NamedTuple):
    """Limits and law that all sensors of a robot share: distance_m = numerator / (counts + bias) - offset."""

    lowest: float
    """Lowest reading of a working sensor, in counts."""
    highest: float
    stuck_ticks: int
    """Ticks of driving within STUCK_BAND until a sensor is stuck."""
    dark_counts: float
    """Lowest reading that may be of a sensor pressed against a wall, in counts."""
    numerator_counts_m: float
    offset_m: float
    bias_counts: float


def sensor_limits(robot: RobotSettings) -> SensorLimits:
    """Return the limits of the sensors of a kind of robot."""
    infrared, frozen_s = robot.infrared, robot.guard.frozen_infrared_s
    return SensorLimits(
        lowest=infrared.floor_counts * LOWEST,
        highest=infrared.plateau_counts * HIGHEST,
        # Never for a sensor whose floor is 0: it repeats that for as long as it sees nothing.
        stuck_ticks=round(STUCK_TIMES * frozen_s / robot.cycle_s) if infrared.floor_counts else 1 << 40,
        dark_counts=_DARK_RATIO * infrared.counts_at(infrared.fold_back_to_m),
        numerator_counts_m=infrared.numerator_counts_m,
        offset_m=infrared.offset_m,
        bias_counts=infrared.bias_counts,
    )


# Places of a sensor's counters. A band is its lowest reading, and its highest in the next place.
_BAND, _QUIET, _BEFORE, _AFTER = 0, 2, 4, 6
_DRIVEN, _STILL_FROM, _LOW_TICKS, _HIGH_TICKS, _AGREED_TICKS, _OUT_TICKS, _PASSES, _CHANGED, SIGNS = range(8, 17)
"""SIGNS: number of counters."""
_UNSEEN = -1000
"""Reading of the bands before the first one."""
NO_SIGNS = (_UNSEEN,) * 4 + (0,) * (SIGNS - 4)
"""Counters of a sensor that was not looked at yet."""


def widen(signs: MutableSequence[int], band: int, value: int) -> None:
    """Widen a band of counts to hold `value`."""
    if value < signs[band]:
        signs[band] = value
    elif value > signs[band + 1]:
        signs[band + 1] = value


def forget_contradictions(signs: MutableSequence[int], way_m: MutableSequence[float]) -> None:
    """Forget the contradictions of a sensor with its neighbours."""
    signs[_LOW_TICKS] = signs[_HIGH_TICKS] = signs[_AGREED_TICKS] = signs[_PASSES] = 0
    way_m[0] = way_m[1] = 0.0


def obstacle_motion_m(
    counts: float, motion: tuple[float, float], beam: Beam, limits: SensorLimits
) -> tuple[float, float]:
    """Return the motion of a standing obstacle that reads `counts` across the beam and along it, in m.

    `motion`: way ahead in m and turn in rad. To the left of the beam and away from the sensor are positive.
    """
    forward_m, turn_rad = motion
    distance_m = limits.numerator_counts_m / (counts + limits.bias_counts) - limits.offset_m
    across_m = forward_m * beam.sine - turn_rad * (beam.along_m + distance_m)
    return across_m, turn_rad * beam.aside_m - forward_m * beam.cosine


def compare_with_neighbours(
    signs: MutableSequence[int],
    way_m: MutableSequence[float],
    readings: tuple[int, int, int, int, int],
    drove: int,
    motion: tuple[float, float],
    beam: Beam,
    limits: SensorLimits,
) -> None:
    """Compare a sensor's band of noise with its neighbours, after `drove` more ticks; arguments as `update_signs`."""
    _, before, after, second_before, second_after = readings
    if signs[_LOW_TICKS] or signs[_HIGH_TICKS]:
        widen(signs, _BEFORE, before)
        widen(signs, _AFTER, after)
    else:  # a neighbour that jumped before the contradiction and is stuck since is no witness
        signs[_BEFORE] = signs[_BEFORE + 1] = before
        signs[_AFTER] = signs[_AFTER + 1] = after
    low, high, nearest = signs[_QUIET], signs[_QUIET + 1], min(before, after)
    if nearest > high:
        if nearest - high > DARK_DIFFERS_COUNTS and high < limits.dark_counts:
            if min(second_before, second_after) - high > AGREES_COUNTS:
                signs[_AGREED_TICKS] += drove
            signs[_LOW_TICKS] += drove
    elif low - before > DIFFERS_COUNTS and low - after > DIFFERS_COUNTS:
        signs[_HIGH_TICKS] += drove
        # Unless a sensor next to a neighbour sees the obstacle, too.
        if low - max(second_before, second_after) > DIFFERS_COUNTS:
            across_m, toward_m = obstacle_motion_m((low + high) / 2, motion, beam, limits)
            way_m[0] = KEEPS * way_m[0] + across_m
            way_m[1] = KEEPS * way_m[1] + toward_m
            if max(abs(way_m[0]), abs(way_m[1])) > PASSES_M:
                signs[_PASSES] = 1


def update_signs(
    signs: MutableSequence[int],
    way_m: MutableSequence[float],
    readings: tuple[int, int, int, int, int],
    driven: int,
    motion: tuple[float, float],
    beam: Beam,
    limits: SensorLimits,
    has_witnesses: bool,
) -> bool:
    """Look at a sensor, and return whether `fault_code` may find a sign.

    Args:
        signs: its SIGNS counters, which change.
        way_m: way past what it sees, across its beam and along it, in m, which changes.
        readings: counts of the sensor, of its neighbours before and after, and of the sensors next to those.
        driven: ticks that the robot has driven.
        motion: way ahead in m and turn in rad since the last look.
        beam: of this sensor.
        limits: of all sensors.
        has_witnesses: whether its neighbours can contradict it.
    """
    value, before, after = readings[0], readings[1], readings[2]
    drove = driven - signs[_DRIVEN]
    signs[_DRIVEN] = driven
    in_range = limits.lowest <= value <= limits.highest
    signs[_OUT_TICKS] = 0 if in_range else min(signs[_OUT_TICKS] + LOOK_TICKS, RANGE_TICKS)
    widen(signs, _BAND, value)
    if signs[_BAND + 1] - signs[_BAND] > STUCK_BAND:
        signs[_BAND] = signs[_BAND + 1] = value
        signs[_STILL_FROM] = driven
    widen(signs, _QUIET, value)
    if signs[_QUIET + 1] - signs[_QUIET] > QUIET_COUNTS + QUIET_RATIO * signs[_QUIET + 1]:
        # It has changed by more than noise.
        signs[_QUIET] = signs[_QUIET + 1] = value
        signs[_BEFORE] = signs[_BEFORE + 1] = before
        signs[_AFTER] = signs[_AFTER + 1] = after
        forget_contradictions(signs, way_m)
        signs[_CHANGED] = 1
    elif drove and has_witnesses:
        compare_with_neighbours(signs, way_m, readings, drove, motion, beam, limits)
    still = driven - signs[_STILL_FROM] >= limits.stuck_ticks
    return signs[_LOW_TICKS] > 0 or signs[_HIGH_TICKS] > 0 or signs[_OUT_TICKS] > 0 or still


_FAULTS = (None, SensorFault.OUT_OF_RANGE, SensorFault.STUCK, SensorFault.SEES_NOTHING, SensorFault.SEES_A_PHANTOM)
"""Signs by the number of `fault_code`."""


def fault_code(signs: MutableSequence[int], driven: int, limits: SensorLimits) -> int:
    """Return the number of the sign that a sensor is broken, 0 without one. `driven`: ticks of driving."""
    if signs[_OUT_TICKS] >= RANGE_TICKS:
        return 1
    if driven - signs[_STILL_FROM] >= limits.stuck_ticks:
        return 2
    before, after = signs[_BEFORE + 1] - signs[_BEFORE], signs[_AFTER + 1] - signs[_AFTER]
    both_change = (
        before > QUIET_COUNTS + QUIET_RATIO * signs[_BEFORE + 1]
        and after > QUIET_COUNTS + QUIET_RATIO * signs[_AFTER + 1]
    )
    if signs[_AGREED_TICKS] >= DARK_TICKS or (both_change and signs[_LOW_TICKS] >= DARK_TICKS):
        return 3
    if signs[_PASSES] or (min(before, after) >= SWING_COUNTS and signs[_HIGH_TICKS] >= PHANTOM_TICKS):
        return 4
    return 0


class SensorSigns:
    """Counters, in ticks of driving, of the signs that one sensor is broken (symptoms).

    For example STUCK: within STUCK_BAND of 2 counts for 4 s, while the others flicker. `SensorWatch` owns one for
    each sensor.
    """

    __slots__ = ("_beam", "_has_witnesses", "_limits", "_looks_alike", "_near", "_signs", "_way_m", "place", "suspect")

    def __init__(self, place: int, near: Neighbours, beam: Beam, limits: SensorLimits) -> None:
        """`place`: in the sensor table."""
        self.place = place
        self._near = near.before, near.after, near.second_before, near.second_after
        self._beam, self._limits = beam, limits
        self._has_witnesses = self._looks_alike = near.has_witnesses
        self.restart(0)

    @property
    def still_from(self) -> int:
        """Ticks that the robot had driven when the reading last left its narrow band."""
        return self._signs[_STILL_FROM]

    @property
    def out_of_range(self) -> bool:
        """Return whether no working sensor gives the newest reading."""
        return self._signs[_OUT_TICKS] > 0

    @property
    def changed(self) -> bool:
        """Return whether the reading has left the band of noise since `note_broken` or `restart`."""
        return self._signs[_CHANGED] > 0

    def note_broken(self) -> None:
        """Wait for a change from now on: the sensor was noticed as broken."""
        self._signs[_CHANGED] = 0

    def set_witnesses(self, broken: Container[int]) -> None:
        """Compare with the neighbours from now on only if neither is among the `broken` sensors.

        `broken`: places in the sensor table.
        """
        self._has_witnesses = self._looks_alike and not any(each in broken for each in self._near[:2])
        forget_contradictions(self._signs, self._way_m)

    def restart(self, driven: int) -> None:
        """Forget all signs; `driven`: ticks that the robot has driven."""
        self._signs, self._way_m = list(NO_SIGNS), [0.0, 0.0]
        self._signs[_DRIVEN] = self._signs[_STILL_FROM] = driven
        self.suspect = False
        """Whether `fault` may find a sign; it spares a call in most ticks."""

    def update(self, counts: tuple[int, ...], driven: int, motion: WheelMotion) -> None:
        """Look at all readings, in counts; `driven`: ticks that the robot has driven; `motion`: since the last look."""
        before, after, second_before, second_after = self._near
        self.suspect = update_signs(
            self._signs,
            self._way_m,
            (counts[self.place], counts[before], counts[after], counts[second_before], counts[second_after]),
            driven,
            (motion.forward_m, motion.turn_rad),
            self._beam,
            self._limits,
            self._has_witnesses,
        )

    def fault(self, driven: int) -> SensorFault | None:
        """Return the sign that the sensor is broken; None without one. `driven`: ticks that the robot has driven."""
        return _FAULTS[fault_code(self._signs, driven, self._limits)]
