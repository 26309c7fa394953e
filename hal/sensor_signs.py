"""Signs that one infra-red sensor is broken: dead, stuck, unplugged, dark or seeing a phantom."""

import math
from collections.abc import Container
from enum import StrEnum
from typing import NamedTuple

from hal.odometry import WheelMotion
from hal.robot_settings import InfraredSettings
from hal.sensor_ring import Neighbours

_DARK_RATIO = 0.9
"""Highest reading of a dark sensor, as a ratio of the reading right before a wall, where the law folds back."""
_DIGITS = 12
"""Sine and cosine differ in their last digits between platforms, and a replay compares bit for bit."""


class Beam(NamedTuple):
    """Sensor model: place and direction of a range sensor, and its law.

    distance_m = numerator / (counts + bias) - offset, along `heading`. `motion_m` says how a standing obstacle moves
    in the beam when the robot drives; `SensorSigns` compares that with the readings.
    """

    place: int
    """Place in the sensor table."""
    sine: float
    """Sine of its heading."""
    cosine: float
    along_m: float
    """Place of the sensor along its beam, from the robot's centre, in m."""
    aside_m: float
    """Place of the sensor across its beam, to the left, in m."""
    numerator_counts_m: float
    offset_m: float
    bias_counts: float
    dark_counts: float
    """Lowest reading that may be of a sensor pressed against a wall, in counts."""

    def motion_m(self, counts: float, motion: WheelMotion) -> tuple[float, float]:
        """Return the motion of a standing obstacle that reads `counts` across the beam and along it, in m.

        `motion`: of the wheels. To the left of the beam and away from the sensor are positive.
        """
        distance_m = self.numerator_counts_m / (counts + self.bias_counts) - self.offset_m
        forward_m, turn_rad = motion.forward_m, motion.turn_rad
        return (
            forward_m * self.sine - turn_rad * (self.along_m + distance_m),
            turn_rad * self.aside_m - forward_m * self.cosine,
        )


def beam_of(infrared: InfraredSettings, place: int) -> Beam:
    """Return the beam of the sensor at `place` of the sensor table."""
    sensor = infrared.sensors[place]
    heading_rad = math.radians(sensor.heading_deg)
    sine, cosine = round(math.sin(heading_rad), _DIGITS), round(math.cos(heading_rad), _DIGITS)
    return Beam(
        place=place,
        sine=sine,
        cosine=cosine,
        along_m=sensor.x_m * cosine + sensor.y_m * sine,
        aside_m=sensor.y_m * cosine - sensor.x_m * sine,
        numerator_counts_m=infrared.numerator_counts_m,
        offset_m=infrared.offset_m,
        bias_counts=infrared.bias_counts,
        dark_counts=_DARK_RATIO * infrared.counts_at(infrared.fold_back_to_m),
    )


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


class SensorLimits(NamedTuple):
    """Limits that all sensors of a robot share: lowest and highest counts, and time without a change."""

    lowest: float
    highest: float
    stuck_ticks: int


class SensorSigns:
    """Counters, in ticks of driving, of the signs that one sensor is broken (symptoms).

    For example STUCK: within STUCK_BAND of 2 counts for 4 s, while the others flicker. `SensorWatch` owns one for
    each sensor.
    """

    __slots__ = (
        "_across_m",
        "_after",
        "_after_high",
        "_after_low",
        "_beam",
        "_before",
        "_before_high",
        "_before_low",
        "_driven",
        "_has_witnesses",
        "_high",
        "_highest",
        "_looks_alike",
        "_low",
        "_lowest",
        "_quiet_high",
        "_quiet_low",
        "_second_after",
        "_second_before",
        "_stuck_ticks",
        "_toward_m",
        "agreed_ticks",
        "changed",
        "high_ticks",
        "low_ticks",
        "out_ticks",
        "passes",
        "place",
        "still_from",
        "suspect",
    )

    def __init__(self, near: Neighbours, beam: Beam, limits: SensorLimits) -> None:
        self.place = beam.place
        self._beam = beam
        self._before, self._after = near.before, near.after
        self._second_before, self._second_after = near.second_before, near.second_after
        self._lowest, self._highest, self._stuck_ticks = limits
        self._has_witnesses = self._looks_alike = near.has_witnesses
        self.restart(0)

    def set_witnesses(self, broken: Container[int]) -> None:
        """Compare with the neighbours from now on only if neither is among the `broken` sensors.

        `broken`: places in the sensor table.
        """
        self._has_witnesses = self._looks_alike and self._before not in broken and self._after not in broken
        self.low_ticks = self.high_ticks = self.agreed_ticks = 0
        self._across_m = self._toward_m = 0.0
        self.passes = False

    def restart(self, driven: int) -> None:
        """Forget all signs; `driven`: ticks that the robot has driven."""
        self._low = self._high = self._quiet_low = self._quiet_high = -1000
        self._before_low = self._before_high = self._after_low = self._after_high = 0
        self._driven = self.still_from = driven
        self.low_ticks = self.high_ticks = self.agreed_ticks = self.out_ticks = 0
        self._across_m = self._toward_m = 0.0
        self.passes = False
        """Whether the wheels have moved the robot past what it sees."""
        self.changed = False
        """Whether the reading has left the band of noise since this was set to False."""
        self.suspect = False
        """Whether `fault` may find a sign; it spares a call in most ticks."""

    def update(self, counts: tuple[int, ...], driven: int, motion: WheelMotion) -> None:
        """Look at all readings, in counts; `driven`: ticks that the robot has driven; `motion`: since the last look."""
        value = counts[self.place]
        drove, self._driven = driven - self._driven, driven
        self.out_ticks = 0 if self._lowest <= value <= self._highest else min(self.out_ticks + LOOK_TICKS, RANGE_TICKS)
        if value < self._low:
            self._low = value
        elif value > self._high:
            self._high = value
        if self._high - self._low > STUCK_BAND:
            self._low = self._high = value
            self.still_from = driven
        if value < self._quiet_low:
            self._quiet_low = value
        elif value > self._quiet_high:
            self._quiet_high = value
        if self._quiet_high - self._quiet_low > QUIET_COUNTS + QUIET_RATIO * self._quiet_high:
            self._begin_quiet(value, counts)
        elif drove and self._has_witnesses:
            self._compare(counts, drove, motion)
        self.suspect = bool(
            self.low_ticks or self.high_ticks or self.out_ticks or driven - self.still_from >= self._stuck_ticks
        )

    def fault(self, driven: int) -> SensorFault | None:
        """Return the sign that the sensor is broken; None without one. `driven`: ticks that the robot has driven."""
        if self.out_ticks >= RANGE_TICKS:
            return SensorFault.OUT_OF_RANGE
        if driven - self.still_from >= self._stuck_ticks:
            return SensorFault.STUCK
        if self.agreed_ticks >= DARK_TICKS or (self.low_ticks >= DARK_TICKS and self._neighbours_change):
            return SensorFault.SEES_NOTHING
        swing = min(self._before_high - self._before_low, self._after_high - self._after_low)
        if self.passes or (swing >= SWING_COUNTS and self.high_ticks >= PHANTOM_TICKS):
            return SensorFault.SEES_A_PHANTOM
        return None

    def _begin_quiet(self, value: int, counts: tuple[int, ...]) -> None:
        """Start the band of noise at this reading: it has changed by more than noise."""
        self._quiet_low = self._quiet_high = value
        self._before_low = self._before_high = counts[self._before]
        self._after_low = self._after_high = counts[self._after]
        self.low_ticks = self.high_ticks = self.agreed_ticks = 0
        self._across_m = self._toward_m = 0.0
        self.passes = False
        self.changed = True

    @property
    def _neighbours_change(self) -> bool:
        """Return whether both neighbours have changed by more than noise while this sensor has not."""
        before, after = self._before_high - self._before_low, self._after_high - self._after_low
        return (
            before > QUIET_COUNTS + QUIET_RATIO * self._before_high
            and after > QUIET_COUNTS + QUIET_RATIO * self._after_high
        )

    def _compare(self, counts: tuple[int, ...], drove: int, motion: WheelMotion) -> None:
        """Compare the band of noise with the neighbours' readings, in counts, after `drove` more ticks of driving."""
        before, after = counts[self._before], counts[self._after]
        if self.low_ticks or self.high_ticks:
            self._widen(before, after)
        else:  # a neighbour that jumped before the contradiction and is stuck since is no witness
            self._before_low = self._before_high = before
            self._after_low = self._after_high = after
        nearest, high = min(before, after), self._quiet_high
        if nearest > high:
            if nearest - high > DARK_DIFFERS_COUNTS and high < self._beam.dark_counts:
                if min(counts[self._second_before], counts[self._second_after]) - high > AGREES_COUNTS:
                    self.agreed_ticks += drove
                self.low_ticks += drove
        elif self._quiet_low - before > DIFFERS_COUNTS and self._quiet_low - after > DIFFERS_COUNTS:
            self._follow_obstacle(counts, motion)
            self.high_ticks += drove

    def _widen(self, before: int, after: int) -> None:
        if before < self._before_low:
            self._before_low = before
        elif before > self._before_high:
            self._before_high = before
        if after < self._after_low:
            self._after_low = after
        elif after > self._after_high:
            self._after_high = after

    def _follow_obstacle(self, counts: tuple[int, ...], motion: WheelMotion) -> None:
        """Add the way past the obstacle, unless a sensor next to a neighbour sees it, too."""
        if self._quiet_low - max(counts[self._second_before], counts[self._second_after]) <= DIFFERS_COUNTS:
            return
        across_m, toward_m = self._beam.motion_m((self._quiet_low + self._quiet_high) / 2, motion)
        self._across_m = KEEPS * self._across_m + across_m
        self._toward_m = KEEPS * self._toward_m + toward_m
        self.passes = self.passes or max(abs(self._across_m), abs(self._toward_m)) > PASSES_M
