"""Fault that a commissioning step found, and reason of a skipped step; `fault_text` has their texts."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Self

Field = str | int | float


class FaultCode(StrEnum):
    """Fault of the robot, its bus or its settings."""

    # Frames on the bus.
    BUS_SILENT = "bus silent"
    BUS_JUNK = "bus junk"
    """Junk alone was received, no frame."""
    IDENTITY_MISSING = "identity missing"
    TWO_ROBOTS = "two robots"
    CONTROLLER_HANGS = "controller hangs"
    FRAME_MISSING = "frame missing"
    FRAME_MISSING_SECOND = "frame missing second"
    """A frame of the second controller never came."""
    FRAME_PERIOD = "frame period"
    JUNK = "junk"
    FOREIGN_CONTROL = "foreign control"
    # Turning wheels.
    BRAKE_FAILS = "brake fails"
    BRAKE_UNHEARD = "brake unheard"
    """No encoder frame came after the brake."""
    BRAKE_SLOW = "brake slow"
    WHEELS_HELD = "wheels held"
    """The guard kept the wheels from turning."""
    NOTHING_TO_STOP = "nothing to stop"
    WATCHDOG_MISSING = "watchdog missing"
    MODE_RAN_AWAY = "mode ran away"
    MODE_SPEED = "mode speed"
    """The measured speed is not the commanded one."""
    MODE_MISSING = "mode missing"
    SIDES_UNEQUAL = "sides unequal"
    # Wiring of the wheels.
    MOTORS_SWAPPED = "motors swapped"
    MOTOR_REVERSED = "motor reversed"
    MOTOR_DEAD = "motor dead"
    MOTOR_ODD = "motor odd"
    ENCODERS_SWAPPED = "encoders swapped"
    ENCODER_REVERSED = "encoder reversed"
    ENCODER_DEAD = "encoder dead"
    ENCODER_ODD = "encoder odd"
    # Distance sensors and bumpers.
    CHANNELS_SILENT = "channels silent"
    SENSORS_NOT_TRIED = "sensors not tried"
    SENSOR_DEAD = "sensor dead"
    CHANNEL_UNHEARD = "channel unheard"
    """A sensor that was chosen for the calibration is silent."""
    NO_CALIBRATION = "no calibration"
    """Only in progress files from before the four `law` codes."""
    LAW_DISTANCES = "law distances"
    """The readings of a calibration cover too few distances."""
    LAW_FLAT = "law flat"
    """The counts hardly fall with distance."""
    LAW_SCATTER = "law scatter"
    LAW_IMPLAUSIBLE = "law implausible"
    ROOM_NOT_CLEAR = "room not clear"
    BUMPERS_SILENT = "bumpers silent"
    BUMPER_HANGS = "bumper hangs"
    BUMPER_NOT_FOUND = "bumper not found"


class SkipCode(StrEnum):
    """Reason that a step was not run."""

    COMMAND_LINE = "command line"
    OPERATOR = "operator"
    NOT_LIFTED = "not lifted"
    NO_MOTION = "no motion"
    NO_SPEED_MODE = "no speed mode"
    NO_SENSOR = "no sensor"


@dataclass(frozen=True, slots=True)
class StepFault:
    """Code with its fields; the fields `cause` and `says` hold text of another part of the program."""

    code: FaultCode
    fields: Mapping[str, Field] = field(default_factory=dict)

    @classmethod
    def of(cls, code: FaultCode, **fields: Field) -> Self:
        """Return the fault of a code; `fields` fill the gaps in the code's text."""
        return cls(code, fields)


class SkippedError(Exception):
    """Raised by a step that cannot run now, with the reason."""

    def __init__(self, code: SkipCode) -> None:
        super().__init__(code)
        self.code = code
