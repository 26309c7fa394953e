"""Schema of the settings of a KURT2: CAN bus, channels of its sensors, and its micro-controller's speed modes."""

import re
from enum import StrEnum
from typing import Annotated, Literal, Self

from pydantic import Field, field_validator, model_validator

from config.settings import Settings, SettingsError
from hal.robot_settings import (
    InfraredSettings,
    MetresPerSecond,
    MotorSettings,
    RobotSettings,
    SensorSettings,
    load_robot,
)


class SpeedMode(StrEnum):
    """Mode in which CONTROL carries set points; the numbers are the firmware's."""

    RAW = "RAW"
    SPEED = "SPEED"
    SPEED_CM = "SPEED_CM"


class CanSettings(Settings):
    """CAN bus between KURT2's micro-controller and this machine: database of frames, bit rate, speed mode."""

    database: str
    bit_rate_bit_s: Annotated[int, Field(gt=0, le=1_000_000)]
    speed_mode: SpeedMode


class Kurt2MotorSettings(MotorSettings):
    """KURT2's motors, with the speeds in m/s that drive values of the modes SPEED and RAW stand for."""

    full_speed_m_s: MetresPerSecond
    """Speed of 100 % in mode SPEED."""
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


DISTANCE_CHANNEL = re.compile(r"ADC(0\d|1[014])|BDC(0\d|1[0-5])")
"""Names of the analog channels that may carry a distance sensor."""

_CURRENT_CHANNELS = ("ADC12", "ADC13")
"""Analog channels of the motor currents (docs/the-robot.md, frame 0x08)."""


class Kurt2SensorSettings(SensorSettings):
    """One infra-red distance sensor with the analog channel that carries it."""

    channel: str

    @field_validator("channel")
    @classmethod
    def _carries_distances(cls, channel: str) -> str:
        if channel in _CURRENT_CHANNELS:
            raise ValueError(f"channel {channel} carries a motor current; use another one")
        if not DISTANCE_CHANNEL.fullmatch(channel):
            raise ValueError("channel must be ADC00 to ADC11, ADC14 or BDC00 to BDC15")
        return channel


class Kurt2InfraredSettings(InfraredSettings):
    """Law of the sensors (GP2D12 class) and their table with channels."""

    sensors: Annotated[tuple[Kurt2SensorSettings, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _channels_differ(self) -> Self:
        self.require_different("channel")
        return self


class Kurt2Settings(RobotSettings):
    """Settings of one KURT2: those of every robot, with its CAN bus, motors and sensor channels."""

    kind: Literal["kurt2"] = "kurt2"
    can: CanSettings
    motors: Kurt2MotorSettings
    infrared: Kurt2InfraredSettings


def require_kurt2(robot: RobotSettings, what: str) -> Kurt2Settings:
    """Return the settings of a KURT2, which `what` needs, such as a command. Raises SettingsError for another robot."""
    if not isinstance(robot, Kurt2Settings):
        raise SettingsError(
            f"{what} needs a KURT2 (got a robot of kind {robot.kind})",
            where=f"robot {robot.name}",
            do="name the settings of a KURT2",
        )
    return robot


def load_kurt2(name_or_path: str = "kurt2") -> Kurt2Settings:
    """Load the settings of a KURT2 by name or path. Raises config.settings.SettingsError, also for another robot."""
    return require_kurt2(load_robot(name_or_path), "what you started")
