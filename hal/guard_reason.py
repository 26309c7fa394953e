"""Codes for why the guard limits or stops the wheels: the words of recordings, of the wire and for users."""

from enum import StrEnum

from config.errors import TextCode


class Effect(StrEnum):
    """Treatment of set points by the guard for a reason."""

    LIMITS = "limits"
    """It applies the safe part of them."""
    BLOCKS = "blocks"
    """It applies none, as long as the reason lasts."""
    LATCHES = "latches"
    """It brakes, and applies none until a release."""


class GuardReason(TextCode):
    """Code for a difference between the wanted and the applied wheel speeds, or for a latched stop.

    Its text continues "stands: ", and its remedy is a sentence. A limit that never stops the robot has none, nor has a
    stop by the program itself, which the code names.
    """

    effect: Effect

    def __init__(self, _value: str, _text: str = "", _do: str = "", effect: Effect = Effect.LATCHES) -> None:
        """Keep what TextCode does not."""
        self.effect = effect

    NOT_A_NUMBER = ("not a number", "the decided speed is not a number", "Teach it another action here", Effect.BLOCKS)
    COMMAND_TOO_OLD = ("command too old", "the computer is too slow", "End other work on it", Effect.BLOCKS)
    CLOCK_RAN_BACKWARDS = (
        "clock ran backwards",
        "the computer's clock ran backwards",
        "Wait until it is right again",
        Effect.BLOCKS,
    )
    INFRARED_STALE = ("range sensors stale", "its range sensors are silent", "Check its power and cable", Effect.BLOCKS)
    ENCODER_STALE = ("encoder stale", "its encoders are silent", "Check its power and cable", Effect.BLOCKS)
    BUMPER_STALE = ("bumper stale", "its bumpers are silent", "Check its power and cable", Effect.BLOCKS)
    FRONT_BUMPER = ("front bumper", "it touches something in front", "Drive it back", Effect.LIMITS)
    REAR_BUMPER = ("rear bumper", "it touches something behind", "Drive it forward", Effect.LIMITS)
    SPEED_LIMIT = ("speed limit", "", "", Effect.LIMITS)
    SLEW_LIMIT = ("slew limit", "", "", Effect.LIMITS)
    BUS_LOST = ("bus lost", "its bus is lost", "Check its power and cable")
    """The bus did not take a frame: unplugged, down, or its transmit queue is full of others' frames."""
    BUS_BLOCKED = ("bus blocked", "its bus carries nothing", "Check its power, cable and bit rate")
    """The bus takes frames and does not carry them: no node acknowledges, or it is full."""
    BUS_OFF = ("bus off", "its bus failed too often", "Check cable, termination and bit rate")
    FOREIGN_CONTROL = ("another CONTROL sender", "another program drives it, too", "Find and end that one")
    FOREIGN_TELEMETRY = ("another telemetry sender", "another program sends its readings, too", "Find and end that one")
    """Another node sends frames with an identifier of the robot's readings."""
    WHEELS_DISOBEY = ("wheels disobey", "its wheels disobey", "Set them free, or switch it off and on")
    INFRARED_FROZEN = ("range sensors frozen", "its range sensors are frozen", "Switch it off and on")
    ROBOT_FAULT = ("robot fault", "it reports a fault of its own", "Mend what it names")
    """The robot itself tells a fault; the health report has its text."""
    TICKS_CEASED = ("ticks ceased", "the computer was too slow{stall}")
    """The watchdog braked because ticks had ceased; `stall` is for how long."""
    CLOSED = "closed"
    SERVICE_ENDS = "the service ends"
    RUN_OVER = "the run is over"
    """A simulated run has ended."""
    PROGRAM_WAITS = "the robot program waits for what it needs"
    CHECKLIST_WAITS = "the checklist waits"
    """Commissioning has no step that drives."""

    @property
    def routine(self) -> bool:
        """True if ordinary driving meets this limit: each turn begins at the slew limit."""
        return self is GuardReason.SLEW_LIMIT
