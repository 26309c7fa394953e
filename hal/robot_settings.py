"""Schema of `config/robots/*.yaml`: the channel table, geometry, limits and the infra-red law of one robot."""

import re
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, field_validator, model_validator

from hal.infrared_law import InfraredLawNumbers, counts_at
from hal.settings import Settings, find_config, load_settings

Metres = Annotated[float, Field(gt=0, le=5)]
MetresPerSecond = Annotated[float, Field(gt=0, le=3)]
MetresPerSecondSquared = Annotated[float, Field(gt=0, le=20)]
Seconds = Annotated[float, Field(gt=0, le=10)]
Counts = Annotated[int, Field(ge=0, le=1023)]
Coordinate = Annotated[float, Field(ge=-1, le=1)]


class SpeedMode(StrEnum):
    """Mode in which CONTROL carries set points; the numbers are the firmware's."""

    RAW = "RAW"
    SPEED = "SPEED"
    SPEED_CM = "SPEED_CM"


class CanSettings(Settings):
    """Bus of the robot's controller."""

    database: str
    bit_rate_bit_s: Annotated[int, Field(gt=0, le=1_000_000)]
    cycle_s: Seconds
    speed_mode: SpeedMode


class GeometrySettings(Settings):
    """Body and wheels."""

    outline_length_m: Metres
    outline_width_m: Metres
    wheel_radius_m: Metres
    effective_track_m: Metres
    metres_per_tick: Annotated[float, Field(gt=0, lt=0.01)]
    mass_kg: Annotated[float, Field(gt=0, le=500)]
    yaw_inertia_kg_m2: Annotated[float, Field(gt=0, le=100)]


class MotorSettings(Settings):
    """Motors with the speed loop of the micro-controller."""

    maximum_speed_m_s: MetresPerSecond
    full_speed_m_s: MetresPerSecond
    acceleration_m_s2: MetresPerSecondSquared
    braking_m_s2: MetresPerSecondSquared
    speed_loop_time_s: Seconds
    controller_watchdog_s: Seconds
    raw_drive: Annotated[tuple[Annotated[int, Field(ge=0, le=1024)], ...], Field(min_length=2)]
    raw_speed_m_s: Annotated[tuple[Annotated[float, Field(ge=0, le=3)], ...], Field(min_length=2)]

    @model_validator(mode="after")
    def _curve_is_a_curve(self) -> Self:
        if len(self.raw_drive) != len(self.raw_speed_m_s):
            raise ValueError("raw_drive and raw_speed_m_s must be of the same length")
        if list(self.raw_drive) != sorted(set(self.raw_drive)) or list(self.raw_speed_m_s) != sorted(
            self.raw_speed_m_s
        ):
            raise ValueError("raw_drive must rise and raw_speed_m_s must not fall")
        return self


class GuardSettings(Settings):
    """Limits of the guard, for every decision."""

    maximum_speed_m_s: MetresPerSecond
    acceleration_m_s2: MetresPerSecondSquared
    braking_m_s2: MetresPerSecondSquared
    stale_infrared_s: Seconds
    stale_encoder_s: Seconds
    stale_bumper_s: Seconds
    command_age_s: Seconds
    ticks_ceased_s: Seconds
    wheel_error_m_s: MetresPerSecond
    wheel_error_share: Annotated[float, Field(ge=0, lt=1)]
    wheel_error_s: Seconds
    frozen_infrared_s: Annotated[float, Field(gt=0, le=3600)]


DISTANCE_CHANNEL = re.compile(r"ADC(0\d|1[014])|BDC(0\d|1[0-5])")
"""Names of the analog channels that may carry a distance sensor."""

_CURRENT_CHANNELS = ("ADC12", "ADC13")
"""Analog channels of the motor currents (docs/the-robot.md, frame 0x08)."""


class SensorSettings(Settings):
    """One infra-red distance sensor: where it sits and the analog channel that carries it."""

    name: str
    label: str
    channel: str
    x_m: Coordinate
    y_m: Coordinate
    heading_deg: Annotated[float, Field(ge=-180, le=180)]

    @field_validator("channel")
    @classmethod
    def _carries_distances(cls, channel: str) -> str:
        if channel in _CURRENT_CHANNELS:
            raise ValueError(f"channel {channel} carries a motor current; use another one")
        if not DISTANCE_CHANNEL.fullmatch(channel):
            raise ValueError("channel must be ADC00 to ADC11, ADC14 or BDC00 to BDC15")
        return channel


class InfraredSettings(Settings):
    """Law of the sensors (GP2D12 class) and their table."""

    numerator_counts_m: Annotated[float, Field(gt=0)]
    offset_m: Metres
    bias_counts: Annotated[float, Field(ge=0)]
    near_m: Metres
    far_m: Metres
    floor_counts: Counts
    plateau_counts: Counts
    fold_back_from_m: Metres
    fold_back_counts_per_m: Annotated[float, Field(gt=0)]
    fold_back_to_m: Metres
    noise_share: Annotated[float, Field(ge=0, le=0.5)]
    noise_least_counts: Annotated[float, Field(ge=0, le=50)]
    gain_spread_share: Annotated[float, Field(ge=0, le=0.5)]
    period_s: Seconds
    period_spread_s: Annotated[float, Field(ge=0, le=1)]
    beam_width_rad: Annotated[float, Field(ge=0, le=1)]
    sensors: Annotated[tuple[SensorSettings, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _table_is_consistent(self) -> Self:
        for what in ("name", "channel"):
            values = [getattr(sensor, what) for sensor in self.sensors]
            twice = sorted({value for value in values if values.count(value) > 1})
            if twice:
                raise ValueError(f"two sensors share the {what} {', '.join(twice)}")
        if not self.fold_back_to_m < self.fold_back_from_m <= self.near_m < self.far_m:
            raise ValueError("must hold: fold_back_to_m < fold_back_from_m <= near_m < far_m")
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """Sensor names in the order of SensorReadings.infrared_counts."""
        return tuple(sensor.name for sensor in self.sensors)

    @property
    def law(self) -> InfraredLawNumbers:
        """Law of the sensors as plain numbers, for loops that use it often."""
        return InfraredLawNumbers(
            numerator_counts_m=self.numerator_counts_m,
            offset_m=self.offset_m,
            bias_counts=self.bias_counts,
            near_m=self.near_m,
            far_m=self.far_m,
            floor_counts=float(self.floor_counts),
            plateau_counts=float(self.plateau_counts),
            fold_back_from_m=self.fold_back_from_m,
            fold_back_counts_per_m=self.fold_back_counts_per_m,
            fold_back_to_m=self.fold_back_to_m,
        )

    def counts_at(self, distance_m: float) -> float:
        """Return the mean reading, fold-back and floor included, in counts (docs/the-robot.md#infra-red-law)."""
        return counts_at(distance_m, self.law)

    def distance_m(self, counts: float) -> float:
        """Return the distance of a reading in counts, between near_m and far_m; far_m at the floor or below."""
        if counts <= self.floor_counts:
            return self.far_m
        return min(self.far_m, max(self.near_m, self.numerator_counts_m / (counts + self.bias_counts) - self.offset_m))


class BumperEnd(StrEnum):
    """The end of the robot a bumper guards."""

    FRONT = "front"
    REAR = "rear"


class BumperSettings(Settings):
    """One bumper; its place in the list is its bit in BUMPERC."""

    name: str
    end: BumperEnd


class RobotSettings(Settings):
    """All settings of one robot."""

    name: str
    can: CanSettings
    geometry: GeometrySettings
    motors: MotorSettings
    guard: GuardSettings
    infrared: InfraredSettings
    bumpers: Annotated[tuple[BumperSettings, ...], Field(max_length=8)]

    @model_validator(mode="after")
    def _guard_within_motors(self) -> Self:
        if self.guard.maximum_speed_m_s > self.motors.maximum_speed_m_s:
            raise ValueError(
                f"guard.maximum_speed_m_s is {self.guard.maximum_speed_m_s}, "
                f"allowed is at most motors.maximum_speed_m_s ({self.motors.maximum_speed_m_s})"
            )
        return self


def load_robot(name_or_path: str = "kurt2") -> RobotSettings:
    """Load the settings of a shipped robot by name, or of a file by path. Raises hal.settings.SettingsError."""
    return load_settings(Path(find_config("robots", name_or_path)), RobotSettings)
