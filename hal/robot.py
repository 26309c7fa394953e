"""Robot protocol: sensor readings, wheel speeds and the result of the guard."""

import math
from typing import NamedTuple, Protocol

from hal.guard_reason import GuardReason


class WheelSpeeds(NamedTuple):
    """Set points of both sides in metres per second, forward positive.

    A named tuple, not a dataclass: several are made in every tick, and a frozen dataclass costs four times as much.
    """

    left_m_s: float
    right_m_s: float


HIGHEST_COUNTS = 1023
"""Largest reading of a sensor: that of a 10-bit converter."""

STANDSTILL = WheelSpeeds(0.0, 0.0)


class SensorReadings(NamedTuple):
    """Newest value of each sensor channel, as of `time_s`, with its age: counts, encoder ticks, bumper bits.

    `Robot.sense` returns one in each tick without waiting. The guard stops a robot whose readings are too old.
    """

    time_s: float
    """Time of the tick on the runtime's clock."""
    infrared_counts: tuple[int, ...]
    """One raw count per sensor, at most HIGHEST_COUNTS, in the order of the sensor table; 0 before the first frame."""
    infrared_age_s: float
    """Age of the oldest of the infra-red frames; infinite while one of them never came."""
    encoder_left_ticks: int
    """Ticks of the left side since the previous SensorReadings, forward positive."""
    encoder_right_ticks: int
    encoder_age_s: float
    """Age of the newest ENCODER frame; infinite before the first."""
    bumpers: int
    """Bit n set: bumper n of the robot's table is pressed."""
    bumper_age_s: float
    """Age of the newest BUMPERC frame; infinite before the first."""


def readings_before_the_first(sensors: int) -> SensorReadings:
    """Return the readings of a robot from which nothing arrived yet: all ages are infinite, so the guard stands.

    `sensors`: number of its distance sensors.
    """
    return SensorReadings(
        time_s=-math.inf,
        infrared_counts=(0,) * sensors,
        infrared_age_s=math.inf,
        encoder_left_ticks=0,
        encoder_right_ticks=0,
        encoder_age_s=math.inf,
        bumpers=0,
        bumper_age_s=math.inf,
    )


class GuardResult(NamedTuple):
    """Answer of the guard to one request: the applied set points in m/s, and why they differ from the wanted ones.

    `Robot.drive` returns it; tick record, page and recording show the reasons.
    """

    wheel_speeds: WheelSpeeds
    """Set points that stand in the CONTROL frame of this tick."""
    reasons: tuple[GuardReason, ...]
    """Why they differ from what was asked for; empty when they do not."""
    latched: bool
    """True while the robot stays stopped until `release` is called (emergency stop, ticks ceased, an alarm)."""


class Robot(Protocol):
    """A robot that the runtime can sense and drive. Every set point passes a guard inside."""

    def sense(self, now_s: float) -> SensorReadings:
        """Take everything that arrived, without waiting, and return the newest values.

        `now_s`: time of the tick on the runtime's clock, in s.
        """
        ...

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        """Request wheel speeds in m/s; the guard sends the safe part of them in this tick's CONTROL frame.

        `decided_at_s`: time of the tick that decided them. `now_s`: present time. Both in s on the runtime's clock.
        """
        ...

    def emergency_stop(self, reason: GuardReason) -> None:
        """Brake now and stay stopped until `release`."""
        ...

    def release(self) -> None:
        """End a latched stop, unless its cause lasts (`GuardResult.latched`). The robot stands until it is driven."""
        ...

    def close(self) -> None:
        """Stop the wheels and close the bus."""
        ...
