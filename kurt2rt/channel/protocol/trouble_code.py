"""Codes of the troubles in a health report."""

from enum import StrEnum
from typing import Final


class TroubleCode(StrEnum):
    """Kind of a trouble; each member names the values that its trouble carries."""

    SENSORS_UNHEARD = "sensors unheard"
    """Name: kind of sensor."""
    SENSORS_SILENT = "sensors silent"
    """Name: kind of sensor. Numbers: age of the newest reading in s."""
    SENSOR_STUCK = "sensor stuck"
    """Name: position and name of one infra-red sensor. Numbers: its reading in counts; as for the next three."""
    SENSOR_OUT_OF_RANGE = "sensor out of range"
    SENSOR_SEES_NOTHING = "sensor sees nothing"
    SENSOR_SEES_A_PHANTOM = "sensor sees a phantom"
    TICKS_MISSED = "ticks missed"
    """Numbers: missed in the last minute, missed in all."""
    TICKS_LATE = "ticks late"
    """Numbers: 99th percentile of lateness in ms."""
    BUS_ALARM = "bus alarm"
    """Line: the driver's."""
    CAN_JUNK = "can junk"
    """Numbers: frames in the last minute, as for the other counters of the bus."""
    CAN_ERROR_FRAMES = "can error frames"
    SEND_FAILURES = "send failures"
    RECEIVE_FAILURES = "receive failures"
    FOREIGN_CONTROL = "foreign control"
    LESSONS_UNSAVED = "lessons unsaved"
    """Line: the journal writer's."""
    SLOW_DISK = "slow disk"
    """Numbers: longest write of the last minute in s."""
    DISK_SILENT = "disk silent"
    """Name: folder."""
    LITTLE_ROOM = "little room"
    """Name: folder. Numbers: free MB."""
    LOW_BATTERY = "low battery"
    """Numbers: charge, 0 to 1."""
    LITTLE_MEMORY = "little memory"
    """Numbers: available MB."""
    DROPS = "drops"
    """Name: queue. Numbers: entries dropped in the last minute."""
    PROGRAM = "program"
    """Name: part of the program. Line: its own."""

    @property
    def about(self) -> str:
        """Subject of the trouble as a word of the wire contract, such as bus."""
        return _ABOUT[self]


_ABOUT: Final = {
    TroubleCode.SENSORS_UNHEARD: "sensors",
    TroubleCode.SENSORS_SILENT: "sensors",
    TroubleCode.SENSOR_STUCK: "sensors",
    TroubleCode.SENSOR_OUT_OF_RANGE: "sensors",
    TroubleCode.SENSOR_SEES_NOTHING: "sensors",
    TroubleCode.SENSOR_SEES_A_PHANTOM: "sensors",
    TroubleCode.TICKS_MISSED: "ticks",
    TroubleCode.TICKS_LATE: "lateness",
    TroubleCode.BUS_ALARM: "bus",
    TroubleCode.CAN_JUNK: "bus",
    TroubleCode.CAN_ERROR_FRAMES: "bus",
    TroubleCode.SEND_FAILURES: "bus",
    TroubleCode.RECEIVE_FAILURES: "bus",
    TroubleCode.FOREIGN_CONTROL: "bus",
    TroubleCode.LESSONS_UNSAVED: "lessons",
    TroubleCode.SLOW_DISK: "lessons",
    TroubleCode.DISK_SILENT: "disk",
    TroubleCode.LITTLE_ROOM: "disk",
    TroubleCode.LOW_BATTERY: "machine",
    TroubleCode.LITTLE_MEMORY: "machine",
    TroubleCode.DROPS: "queues",
    TroubleCode.PROGRAM: "program",
}
