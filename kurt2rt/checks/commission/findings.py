"""Findings of a commissioning that go into the robot's settings."""

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from config.settings import Settings
from hal.kurt2_settings import SpeedMode


class LawFound(Settings):
    """Infra-red calibration fitted to readings at known distances."""

    numerator_counts_m: float
    offset_m: float
    bias_counts: float
    near_m: float
    far_m: float
    floor_counts: int
    plateau_counts: int


class Findings(Settings):
    """Measured values; None or absent: not measured, the base settings hold."""

    hardware_id: int | None = None
    firmware: int | None = None
    speed_mode: SpeedMode | None = None
    full_speed_m_s: float | None = None
    """Speed at 100 % in SPEED mode, if that mode answered."""
    controller_watchdog_s: Annotated[float, Field(gt=0)] | None = None
    channels: Mapping[str, str] = Field(default={})
    """Analog channel by sensor name."""
    dead_sensors: tuple[str, ...] = ()
    bumper_bits: Mapping[str, int] = Field(default={})
    """Bit by bumper name."""
    law: LawFound | None = None
