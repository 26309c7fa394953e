"""Texts of the troubles in a health report: fault and remedy."""

from collections.abc import Sequence
from string import Formatter
from typing import Final

from kurt2rt.channel.protocol.trouble_code import TroubleCode

_SWITCH_ON = "check that the robot is switched on and its cable is plugged in; the robot stands until they are back"
_END_OTHER_WORK = "end other work on this machine; kurt2rt doctor shows what it lacks, real_time_priority helps"
_CHECK_CABLE = "check cable, termination and bit rate"
_CHECK_SENSOR = "check its plug and its lens; until then the sensors next to it stand in for it"
_LINE: Final = ("", "")

_TEXTS: Final[dict[TroubleCode, tuple[str, str]]] = {
    TroubleCode.SENSORS_UNHEARD: ("the {name} have never been heard", _SWITCH_ON),
    TroubleCode.SENSORS_SILENT: ("the {name} are silent, the newest is {0:.1f} s old", _SWITCH_ON),
    TroubleCode.SENSOR_STUCK: (
        "the range sensor {name} is stuck at {0:.0f} counts while the others flicker",
        _CHECK_SENSOR,
    ),
    TroubleCode.SENSOR_OUT_OF_RANGE: (
        "the range sensor {name} reads {0:.0f} counts, as no working sensor does",
        _CHECK_SENSOR,
    ),
    TroubleCode.SENSOR_SEES_NOTHING: (
        "the range sensor {name} stays at {0:.0f} counts while both sensors next to it see something near",
        _CHECK_SENSOR,
    ),
    TroubleCode.SENSOR_SEES_A_PHANTOM: (
        "the range sensor {name} stays at {0:.0f} counts while both sensors next to it see nothing so near",
        _CHECK_SENSOR,
    ),
    TroubleCode.TICKS_MISSED: ("{0:.0f} {ticks} missed in the last minute, {1:.0f} in all", _END_OTHER_WORK),
    TroubleCode.TICKS_LATE: ("one tick in a hundred begins {0:.1f} ms late or later", _END_OTHER_WORK),
    TroubleCode.BUS_ALARM: _LINE,
    TroubleCode.CAN_JUNK: ("{0:.0f} CAN frames with junk in them in the last minute", _CHECK_CABLE),
    TroubleCode.CAN_ERROR_FRAMES: ("{0:.0f} CAN error frames in the last minute", _CHECK_CABLE),
    TroubleCode.SEND_FAILURES: ("{0:.0f} CONTROL frames that the bus did not take in the last minute", _CHECK_CABLE),
    TroubleCode.RECEIVE_FAILURES: ("{0:.0f} times that the bus could not be read in the last minute", _CHECK_CABLE),
    TroubleCode.FOREIGN_CONTROL: (
        "{0:.0f} CONTROL frames of another sender in the last minute",
        "find that sender and end it",
    ),
    TroubleCode.LESSONS_UNSAVED: _LINE,
    TroubleCode.SLOW_DISK: (
        "in the last minute the disk took up to {0:.1f} s to save a lesson",
        "end what else writes to it; kurt2rt doctor measures it",
    ),
    TroubleCode.DISK_SILENT: ("the disk of {name} does not answer", "look at its health and its mount"),
    TroubleCode.LITTLE_ROOM: (
        "only {0:.0f} MB are free for {name}",
        "make room on that disk, or move old recordings away",
    ),
    TroubleCode.LOW_BATTERY: ("this machine's battery has {0:.0%} left", "plug it in"),
    TroubleCode.LITTLE_MEMORY: ("this machine has {0:.0f} MB of memory left", "end other programs"),
    TroubleCode.DROPS: (
        "{name}: {0:.0f} thrown away in the last minute, because they came too fast",
        "",
    ),
    TroubleCode.PROGRAM: _LINE,
}


def numbers_of(code: TroubleCode) -> int:
    """Return how many numbers the text of a code needs."""
    fields = (field for _, field, _, _ in Formatter().parse(_TEXTS[code][0]))
    return sum(field is not None and field.isdigit() for field in fields)


def trouble_text(code: TroubleCode, name: str, numbers: Sequence[float], line: str) -> tuple[str, str]:
    """Return the fault and the remedy, which is empty if only waiting helps.

    Args:
        code: kind of the trouble.
        name: subject of its text.
        numbers: as many as the code has.
        line: `what is wrong; what to do`, of codes without a text of their own.
    """
    what, to_do = _TEXTS[code]
    if not what:
        what, _, to_do = line.partition("; ")
        return what, to_do
    ticks = "tick" if numbers and numbers[0] == 1 else "ticks"
    return what.format(*numbers, name=name, ticks=ticks), to_do
