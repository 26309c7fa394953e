"""Codes of the troubles in a health report, and their texts: fault and remedy."""

from collections.abc import Sequence

from config.errors import TextCode

_SWITCH_ON = "check that the robot is switched on and its cable is plugged in; the robot stands until they are back"
_END_OTHER_WORK = "end other work on this machine; kurt2rt doctor shows what it lacks, real_time_priority helps"
_CHECK_CABLE = "check cable, termination and bit rate"
_CHECK_SENSOR = "check its plug and its lens; until then the sensors next to it stand in for it"


class TroubleCode(TextCode):
    """Kind of a trouble with its text; each member names the values that its trouble carries.

    Without a text the trouble's line tells. Without a remedy only waiting helps.
    """

    about: str
    """Subject on the wire."""

    def __init__(self, _value: str, _text: str = "", _do: str = "", about: str = "") -> None:
        """Keep what TextCode does not."""
        self.about = about

    SENSORS_UNHEARD = ("sensors unheard", "the {name} have never been heard", _SWITCH_ON, "sensors")
    """Name: kind of sensor."""
    SENSORS_SILENT = ("sensors silent", "the {name} are silent, the newest is {0:.1f} s old", _SWITCH_ON, "sensors")
    """Name: kind of sensor. Numbers: age of the newest reading in s."""
    SENSOR_STUCK = (
        "sensor stuck",
        "the range sensor {name} is stuck at {0:.0f} counts while the others flicker",
        _CHECK_SENSOR,
        "sensors",
    )
    """Name: position and name of one infra-red sensor. Numbers: its reading in counts; as for the next three."""
    SENSOR_OUT_OF_RANGE = (
        "sensor out of range",
        "the range sensor {name} reads {0:.0f} counts, as no working sensor does",
        _CHECK_SENSOR,
        "sensors",
    )
    SENSOR_SEES_NOTHING = (
        "sensor sees nothing",
        "the range sensor {name} stays at {0:.0f} counts while both sensors next to it see something near",
        _CHECK_SENSOR,
        "sensors",
    )
    SENSOR_SEES_A_PHANTOM = (
        "sensor sees a phantom",
        "the range sensor {name} stays at {0:.0f} counts while both sensors next to it see nothing so near",
        _CHECK_SENSOR,
        "sensors",
    )
    TICKS_MISSED = (
        "ticks missed",
        "{0:.0f} {ticks} missed in the last minute, {1:.0f} in all",
        _END_OTHER_WORK,
        "ticks",
    )
    """Numbers: missed in the last minute, missed in all."""
    TICKS_LATE = ("ticks late", "one tick in a hundred begins {0:.1f} ms late or later", _END_OTHER_WORK, "lateness")
    """Numbers: 99th percentile of lateness in ms."""
    BUS_ALARM = ("bus alarm", "", "", "bus")
    """Line: the driver's."""
    CAN_JUNK = ("can junk", "{0:.0f} CAN frames with junk in them in the last minute", _CHECK_CABLE, "bus")
    """Numbers: frames in the last minute, as for the other counters of the bus."""
    CAN_ERROR_FRAMES = ("can error frames", "{0:.0f} CAN error frames in the last minute", _CHECK_CABLE, "bus")
    SEND_FAILURES = (
        "send failures",
        "{0:.0f} CONTROL frames that the bus did not take in the last minute",
        _CHECK_CABLE,
        "bus",
    )
    RECEIVE_FAILURES = (
        "receive failures",
        "{0:.0f} times that the bus could not be read in the last minute",
        _CHECK_CABLE,
        "bus",
    )
    FOREIGN_CONTROL = (
        "foreign control",
        "{0:.0f} CONTROL frames of another sender in the last minute",
        "find that sender and end it",
        "bus",
    )
    LESSONS_UNSAVED = ("lessons unsaved", "", "", "lessons")
    """Line: the journal writer's."""
    SLOW_DISK = (
        "slow disk",
        "in the last minute the disk took up to {0:.1f} s to save a lesson",
        "end what else writes to it; kurt2rt doctor measures it",
        "lessons",
    )
    """Numbers: longest write of the last minute in s."""
    DISK_SILENT = ("disk silent", "the disk of {name} does not answer", "look at its health and its mount", "disk")
    """Name: folder."""
    LITTLE_ROOM = (
        "little room",
        "only {0:.0f} MB are free for {name}",
        "make room on that disk, or move old recordings away",
        "disk",
    )
    """Name: folder. Numbers: free MB."""
    LOW_BATTERY = ("low battery", "this machine's battery has {0:.0%} left", "plug it in", "machine")
    """Numbers: charge, 0 to 1."""
    LITTLE_MEMORY = ("little memory", "this machine has {0:.0f} MB of memory left", "end other programs", "machine")
    """Numbers: available MB."""
    DROPS = ("drops", "{name}: {0:.0f} thrown away in the last minute, because they came too fast", "", "queues")
    """Name: queue. Numbers: entries dropped in the last minute."""
    PROGRAM = ("program", "", "", "program")
    """Name: part of the program. Line: its own."""


def numbers_of(code: TroubleCode) -> int:
    """Return how many numbers the text of a code needs."""
    return sum(field.isdigit() for field in code.fields)


def trouble_text(code: TroubleCode, name: str, numbers: Sequence[float], line: str) -> tuple[str, str]:
    """Return the fault and the remedy, which is empty if only waiting helps.

    Args:
        code: kind of the trouble.
        name: subject of its text.
        numbers: as many as the code has.
        line: `what is wrong; what to do`, of codes without a text of their own.
    """
    what, to_do = code.text, code.do
    if not what:
        what, _, to_do = line.partition("; ")
        return what, to_do
    ticks = "tick" if numbers and numbers[0] == 1 else "ticks"
    return what.format(*numbers, name=name, ticks=ticks), to_do
