"""Texts of a commissioning's faults, each with the instruction that mends it, and of skipped steps."""

from collections.abc import Mapping
from string import Formatter

from kurt2rt.checks.commission.fault import FaultCode, SkipCode, StepFault

_TEXTS: Mapping[FaultCode, str] = {
    FaultCode.BUS_SILENT: "Nothing was heard: is the robot on, the cable in, the interface up at "
    "{bit_rate_bit_s} bit/s, the bus terminated at both ends?",
    FaultCode.BUS_JUNK: "{junk}: {count} of them; check the bit rate",
    FaultCode.IDENTITY_MISSING: "INFO_1 (0x04) never came: this is not the KURT2 controller, or it has not started",
    FaultCode.TWO_ROBOTS: "{message} comes from {robots}: two robots; take one off the bus",
    FaultCode.CONTROLLER_HANGS: "{message}'s loop counter does not advance: the controller hangs; switch it off and on",
    FaultCode.FRAME_MISSING: "{frame} never came: check the frame's source, or take its sensors out of the table",
    FaultCode.FRAME_MISSING_SECOND: "{frame} never came: check the frame's source of the second controller, "
    "or take its sensors out of the table",
    FaultCode.FRAME_PERIOD: "{frame}: every {period_ms:.1f} ms, the settings expect {expected_ms:.0f} ms; "
    "frames are lost (see ip -s link), or cycle_s is another on this robot",
    FaultCode.JUNK: "{count} x {junk}: find who sends it, or the loose contact",
    FaultCode.FOREIGN_CONTROL: "{count} CONTROL frames from another program: find that program and end it",
    FaultCode.BRAKE_FAILS: "The wheels still turn after the brake: SWITCH THE MOTORS OFF, then look for the reason",
    FaultCode.BRAKE_UNHEARD: "The wheels are not heard of any more after the brake: SWITCH THE MOTORS OFF, "
    "then look for the reason",
    FaultCode.BRAKE_SLOW: "The brake took {took_s:.2f} s, allowed are {most_s} s: "
    "does the firmware know RAW and its brake bit?",
    FaultCode.WHEELS_HELD: "{drive}: the wheels were kept from turning: {cause}",
    FaultCode.NOTHING_TO_STOP: "The wheels did not turn, so nothing could stop them: {cause}",
    FaultCode.WATCHDOG_MISSING: "Without CONTROL the wheels turned on for {silent_s} s: this controller does not stop "
    "by itself. Never drive it out of reach of a switch that cuts the motors",
    FaultCode.MODE_RAN_AWAY: "{mode}: {cause} and were braked; an encoder that counts the wrong way does that: go on, "
    "step wheels tells which; then repeat this one",
    FaultCode.MODE_SPEED: "{mode}: {ratio:.2f} times as fast as told, by the encoders. Turn a wheel once by hand: "
    "{ticks:.0f} ticks are expected (5120 on the high-speed variant). Mend geometry.metres_per_tick or, "
    "where the mode is RAW, motors.raw_speed_m_s",
    FaultCode.MODE_MISSING: "No speed mode answers: check the motors' supply, their fuses and the emergency switch",
    FaultCode.SIDES_UNEQUAL: "One side turns much slower than the other: look for a wheel that rubs, a slack belt, "
    "a weak motor",
    FaultCode.MOTORS_SWAPPED: "The motors are exchanged: exchange the left and the right motor's plugs "
    "at the controller",
    FaultCode.MOTOR_REVERSED: "The {side} motor turns the wrong way: exchange its two leads",
    FaultCode.MOTOR_DEAD: "The {side} motor does not turn: check its plug, its fuse and its supply",
    FaultCode.MOTOR_ODD: "The {side} motor's order turns {motion}: check the wiring of both motors",
    FaultCode.ENCODERS_SWAPPED: "The encoders are exchanged: exchange the left and the right encoder's plugs "
    "at the controller",
    FaultCode.ENCODER_REVERSED: "The {side} encoder counts the wrong way: exchange its channels A and B",
    FaultCode.ENCODER_DEAD: "The {side} encoder counts nothing while its wheels turn: check its plug and its supply",
    FaultCode.ENCODER_ODD: "While the {side} wheels turn, {motion} is counted: check the wiring of both encoders",
    FaultCode.CHANNELS_SILENT: "No analog channel is heard: is the robot on? Step identity tells which frames come",
    FaultCode.SENSORS_NOT_TRIED: "Not tried: {sensors}; this step goes on with them when it is repeated",
    FaultCode.SENSOR_DEAD: "{sensor} answers on no channel: check its plug and its 5 V, then repeat this step",
    FaultCode.CHANNEL_UNHEARD: "A chosen sensor's channel is not heard: take the step sensors first",
    FaultCode.NO_CALIBRATION: "No law was fitted: {says}",
    FaultCode.LAW_DISTANCES: "No law was fitted: {least} distances at least, from 0.15 m or less to 0.40 m or more, "
    "are needed",
    FaultCode.LAW_FLAT: "No law was fitted: {near_counts:.0f} counts at {near_m:.2f} m and {far_counts:.0f} "
    "at {far_m:.2f} m: they hardly fall with distance, so the sensor does not see the board, "
    "or the channel is another sensor's",
    FaultCode.LAW_SCATTER: "No law was fitted: the readings scatter too much around any law: "
    "was the board where it was asked for?",
    FaultCode.LAW_IMPLAUSIBLE: "No law was fitted: {counts:.0f} counts at {distance_m:.2f} m, "
    "plausible are {least_counts:.0f} to {most_counts:.0f}",
    FaultCode.ROOM_NOT_CLEAR: "With nothing in view the sensor says as much as before a board at {distance_m:.2f} m: "
    "clear a metre around the robot, then repeat this step",
    FaultCode.BUMPERS_SILENT: "BUMPERC (0x0A) never came: this robot has no bumpers, or they are not connected",
    FaultCode.BUMPER_HANGS: "{bits} pressed without a touch: a bumper hangs",
    FaultCode.BUMPER_NOT_FOUND: "{bumper}: no bit answered, or it was skipped; check its switch and its plug",
}

_SKIPPED: Mapping[SkipCode, str] = {
    SkipCode.COMMAND_LINE: "as was wished on the command line",
    SkipCode.OPERATOR: "as you wished",
    SkipCode.NOT_LIFTED: "the wheels were not confirmed off the ground",
    SkipCode.NO_MOTION: "the wheels were not to turn",
    SkipCode.NO_SPEED_MODE: "no speed mode is known to answer: take the step modes first",
    SkipCode.NO_SENSOR: "no sensor answers: take the step sensors first",
}


def fault_text(fault: StepFault) -> str:
    """Return the fault and its instruction in a line. Raises KeyError for a missing field."""
    return _TEXTS[fault.code].format(**fault.fields)


def skip_text(code: SkipCode) -> str:
    """Return the reason that a step was skipped, for the report."""
    return _SKIPPED[code]


def fields_of(code: FaultCode) -> frozenset[str]:
    """Return the names of the fields in the text of a code."""
    return frozenset(name for _, name, _, _ in Formatter().parse(_TEXTS[code]) if name)
