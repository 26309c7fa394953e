"""Reports of a robot that is well, and of one that is not."""

from dataclasses import replace

from hal.bus_state import ControllerState
from hal.health import Health
from kurt2rt.channel.protocol.health import (
    BusHealth,
    DiskSpace,
    Drops,
    HealthReport,
    JournalHealth,
    MachineHealth,
    SensorAges,
    TickLateness,
    Trouble,
)
from kurt2rt.channel.protocol.trouble_code import TroubleCode

A_BUS = Health(1000, 0, 0, 0, 0, 0, "", ControllerState.ACTIVE, "", "", None)
"""Health of a bus on which nothing is wrong."""
WELL = HealthReport(
    version="0.1.0",
    boot="626f6f74",
    robot="kurt2-indoor",
    task="wall_following",
    knowledge="var/wall_following.knowledge",
    started_at="2026-11-22T03:02:43+00:00",
    uptime_s=7384.0,
    tick=738_400,
    doing="forward by RLA 12",
    rlas=90,
    actions=8,
    lessons=123,
    punctuality=TickLateness(0.13, 0.08, 0.31, 0.9, 0.36, 738_399, 0, 0),
    ages=SensorAges(0.004, 0.004, 0.004),
    bus=BusHealth("error-active", 5_168_800, 0, 0, 0, 0, 0),
    disks=(DiskSpace("knowledge", 79_893_155_840),),
    safety=JournalHealth(0, 4.2),
    machine=MachineHealth(136_183_808, 24_383_254_528, 0.12, 9, 0.83, True),
    drops=(Drops("lines for the terminal", 0),),
    troubles=(),
)
SILENT = Trouble(TroubleCode.SENSORS_SILENT, 2.4, True, "range sensors", (2.5,))
LATE = Trouble(TroubleCode.TICKS_MISSED, 185.0, False, numbers=(3, 7))
ILL = replace(
    WELL,
    doing="stands: blind",
    punctuality=TickLateness(4.5, 0.1, 2.9, 31.0, 0.9, 738_392, 7, 3),
    ages=SensorAges(2.5, 0.004, None),
    disks=(DiskSpace("knowledge", 412_000_000), DiskSpace("recordings", None)),
    safety=JournalHealth(2, 840.0),
    drops=(Drops("lines for the terminal", 12),),
    troubles=(SILENT, LATE),
)
