"""Fault that a commissioning step found, with the instruction that mends it, and reason of a skipped step."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Self

from config.errors import TextCode

Field = str | int | float


class FaultCode(TextCode):
    """Code of a fault that a commissioning step found, with the instruction that mends it."""

    # Frames on the bus.
    BUS_SILENT = (
        "bus silent",
        "Nothing was heard: is the robot on, the cable in, the interface up at "
        "{bit_rate_bit_s} bit/s, the bus terminated at both ends?",
    )
    BUS_JUNK = ("bus junk", "{junk}: {count} of them; check the bit rate")
    """Junk alone was received, no frame."""
    IDENTITY_MISSING = (
        "identity missing",
        "INFO_1 (0x04) never came: this is not the KURT2 controller, or it has not started",
    )
    TWO_ROBOTS = ("two robots", "{message} comes from {robots}: two robots; take one off the bus")
    CONTROLLER_HANGS = (
        "controller hangs",
        "{message}'s loop counter does not advance: the controller hangs; switch it off and on",
    )
    FRAME_MISSING = (
        "frame missing",
        "{frame} never came: check the frame's source, or take its sensors out of the table",
    )
    FRAME_MISSING_SECOND = (
        "frame missing second",
        "{frame} never came: check the frame's source of the second controller, or take its sensors out of the table",
    )
    """A frame of the second controller never came."""
    FRAME_PERIOD = (
        "frame period",
        "{frame}: every {period_ms:.1f} ms, the settings expect {expected_ms:.0f} ms; "
        "frames are lost (see ip -s link), or cycle_s is another on this robot",
    )
    JUNK = ("junk", "{count} x {junk}: find who sends it, or the loose contact")
    FOREIGN_CONTROL = ("foreign control", "{count} CONTROL frames from another program: find that program and end it")
    # Turning wheels.
    BRAKE_FAILS = (
        "brake fails",
        "The wheels still turn after the brake: SWITCH THE MOTORS OFF, then look for the reason",
    )
    BRAKE_UNHEARD = (
        "brake unheard",
        "The wheels are not heard of any more after the brake: SWITCH THE MOTORS OFF, then look for the reason",
    )
    """No encoder frame came after the brake."""
    BRAKE_SLOW = (
        "brake slow",
        "The brake took {took_s:.2f} s, allowed are {most_s} s: does the firmware know RAW and its brake bit?",
    )
    WHEELS_HELD = ("wheels held", "{drive}: the wheels were kept from turning: {cause}")
    """The guard kept the wheels from turning."""
    NOTHING_TO_STOP = ("nothing to stop", "The wheels did not turn, so nothing could stop them: {cause}")
    WATCHDOG_MISSING = (
        "watchdog missing",
        "Without CONTROL the wheels turned on for {silent_s} s: this controller does not stop "
        "by itself. Never drive it out of reach of a switch that cuts the motors",
    )
    MODE_RAN_AWAY = (
        "mode ran away",
        "{mode}: {cause} and were braked; an encoder that counts the wrong way does that: go on, "
        "step wheels tells which; then repeat this one",
    )
    MODE_SPEED = (
        "mode speed",
        "{mode}: {ratio:.2f} times as fast as told, by the encoders. Turn a wheel once by hand: "
        "{ticks:.0f} ticks are expected (5120 on the high-speed variant). Mend geometry.metres_per_tick or, "
        "where the mode is RAW, motors.raw_speed_m_s",
    )
    """The measured speed is not the commanded one."""
    MODE_MISSING = (
        "mode missing",
        "No speed mode answers: check the motors' supply, their fuses and the emergency switch",
    )
    SIDES_UNEQUAL = (
        "sides unequal",
        "One side turns much slower than the other: look for a wheel that rubs, a slack belt, a weak motor",
    )
    # Wiring of the wheels.
    MOTORS_SWAPPED = (
        "motors swapped",
        "The motors are exchanged: exchange the left and the right motor's plugs at the controller",
    )
    MOTOR_REVERSED = ("motor reversed", "The {side} motor turns the wrong way: exchange its two leads")
    MOTOR_DEAD = ("motor dead", "The {side} motor does not turn: check its plug, its fuse and its supply")
    MOTOR_ODD = ("motor odd", "The {side} motor's order turns {motion}: check the wiring of both motors")
    ENCODERS_SWAPPED = (
        "encoders swapped",
        "The encoders are exchanged: exchange the left and the right encoder's plugs at the controller",
    )
    ENCODER_REVERSED = ("encoder reversed", "The {side} encoder counts the wrong way: exchange its channels A and B")
    ENCODER_DEAD = (
        "encoder dead",
        "The {side} encoder counts nothing while its wheels turn: check its plug and its supply",
    )
    ENCODER_ODD = (
        "encoder odd",
        "While the {side} wheels turn, {motion} is counted: check the wiring of both encoders",
    )
    # Distance sensors and bumpers.
    CHANNELS_SILENT = (
        "channels silent",
        "No analog channel is heard: is the robot on? Step identity tells which frames come",
    )
    SENSORS_NOT_TRIED = ("sensors not tried", "Not tried: {sensors}; this step goes on with them when it is repeated")
    SENSOR_DEAD = ("sensor dead", "{sensor} answers on no channel: check its plug and its 5 V, then repeat this step")
    CHANNEL_UNHEARD = ("channel unheard", "A chosen sensor's channel is not heard: take the step sensors first")
    """A sensor that was chosen for the calibration is silent."""
    LAW_DISTANCES = (
        "law distances",
        "No law was fitted: {least} distances at least, from 0.15 m or less to 0.40 m or more, are needed",
    )
    """The readings of a calibration cover too few distances."""
    LAW_FLAT = (
        "law flat",
        "No law was fitted: {near_counts:.0f} counts at {near_m:.2f} m and {far_counts:.0f} "
        "at {far_m:.2f} m: they hardly fall with distance, so the sensor does not see the board, "
        "or the channel is another sensor's",
    )
    """The counts hardly fall with distance."""
    LAW_SCATTER = (
        "law scatter",
        "No law was fitted: the readings scatter too much around any law: was the board where it was asked for?",
    )
    LAW_IMPLAUSIBLE = (
        "law implausible",
        "No law was fitted: {counts:.0f} counts at {distance_m:.2f} m, "
        "plausible are {least_counts:.0f} to {most_counts:.0f}",
    )
    ROOM_NOT_CLEAR = (
        "room not clear",
        "With nothing in view the sensor says as much as before a board at {distance_m:.2f} m: "
        "clear a metre around the robot, then repeat this step",
    )
    BUMPERS_SILENT = (
        "bumpers silent",
        "BUMPERC (0x0A) never came: this robot has no bumpers, or they are not connected",
    )
    BUMPER_HANGS = ("bumper hangs", "{bits} pressed without a touch: a bumper hangs")
    BUMPER_NOT_FOUND = (
        "bumper not found",
        "{bumper}: no bit answered, or it was skipped; check its switch and its plug",
    )


class SkipCode(TextCode):
    """Code for why a commissioning step was not run, kept in the progress file."""

    COMMAND_LINE = ("command line", "as was wished on the command line")
    OPERATOR = ("operator", "as you wished")
    NOT_LIFTED = ("not lifted", "the wheels were not confirmed off the ground")
    NO_MOTION = ("no motion", "the wheels were not to turn")
    NO_SPEED_MODE = ("no speed mode", "no speed mode is known to answer: take the step modes first")
    NO_SENSOR = ("no sensor", "no sensor answers: take the step sensors first")


@dataclass(frozen=True, slots=True)
class StepFault:
    """Code with its fields; the fields `cause` and `says` hold text of another part of the program."""

    code: FaultCode
    fields: Mapping[str, Field] = field(default_factory=dict)

    @classmethod
    def of(cls, code: FaultCode, **fields: Field) -> Self:
        """Return the fault of a code; `fields` fill the gaps in the code's text."""
        return cls(code, fields)

    @property
    def text(self) -> str:
        """Fault and its instruction in a line. Raises KeyError for a missing field."""
        return self.code.text.format(**self.fields)


class SkippedError(Exception):
    """Raised by a step that cannot run now, with the reason."""

    def __init__(self, code: SkipCode) -> None:
        super().__init__(code)
        self.code = code
