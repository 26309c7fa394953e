"""Codes for why the guard limits or stops the wheels: the words of recordings, of the wire and for users."""

from enum import StrEnum


class GuardReason(StrEnum):
    """Code for a difference between the wanted and the applied wheel speeds, or for a latched stop."""

    NOT_A_NUMBER = "not a number"
    COMMAND_TOO_OLD = "command too old"
    CLOCK_RAN_BACKWARDS = "clock ran backwards"
    INFRARED_STALE = "range sensors stale"
    ENCODER_STALE = "encoder stale"
    BUMPER_STALE = "bumper stale"
    FRONT_BUMPER = "front bumper"
    REAR_BUMPER = "rear bumper"
    SPEED_LIMIT = "speed limit"
    SLEW_LIMIT = "slew limit"
    BUS_LOST = "bus lost"
    """The bus did not take a frame: unplugged, down, or its transmit queue is full of others' frames."""
    BUS_BLOCKED = "bus blocked"
    """The bus takes frames and does not carry them: no node acknowledges, or it is full."""
    BUS_OFF = "bus off"
    FOREIGN_CONTROL = "another CONTROL sender"
    FOREIGN_TELEMETRY = "another telemetry sender"
    """Another node sends frames with an identifier of the robot's readings."""
    WHEELS_DISOBEY = "wheels disobey"
    INFRARED_FROZEN = "range sensors frozen"
    ROBOT_FAULT = "robot fault"
    """The robot itself tells a fault."""
    TICKS_CEASED = "ticks ceased"
    CLOSED = "closed"
    """The driver was closed."""
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
