"""The report as plain values, for JSON and CBOR, and back. Names are those of the fields."""

from typing import Any

from kurt2rt.channel.maps import MapOf, plainly
from kurt2rt.channel.schema import Flag, ManyOf, OrNone, Real, Text, Whole
from kurt2rt.health.report import (
    BusHealth,
    DiskSpace,
    Drops,
    HealthReport,
    Machine,
    Punctuality,
    Safety,
    SensorAges,
    Trouble,
)

MOST_ROWS = 16
"""Of troubles, disks and queues; more are not told."""

_COUNT = Whole(0, 2**53)
_TIME = Real(1e12)
_NAME = Text(128)
_LINE = Text(512)

_MILLISECONDS = dict.fromkeys(("newest_ms", "median_ms", "p99_ms", "worst_ms", "took_p99_ms"), _TIME)
_REPORT = MapOf(
    HealthReport,
    version=_NAME,
    boot=_NAME,
    robot=_NAME,
    task=_NAME,
    knowledge=_LINE,
    started_at=_NAME,
    uptime_s=_TIME,
    tick=_COUNT,
    doing=_LINE,
    rlas=_COUNT,
    lessons=_COUNT,
    punctuality=MapOf(Punctuality, **_MILLISECONDS, ticks=_COUNT, missed=_COUNT, missed_lately=_COUNT),
    ages=MapOf(SensorAges, infrared_s=OrNone(_TIME), encoders_s=OrNone(_TIME), bumpers_s=OrNone(_TIME)),
    bus=OrNone(
        MapOf(
            BusHealth,
            controller=_NAME,
            frames=_COUNT,
            junk=_COUNT,
            error_frames=_COUNT,
            foreign_control=_COUNT,
            send_failures=_COUNT,
            receive_failures=_COUNT,
        )
    ),
    disks=ManyOf(MapOf(DiskSpace, of=_NAME, free_bytes=OrNone(_COUNT)), most=MOST_ROWS),
    safety=MapOf(Safety, unwritten=_COUNT, last_write_ms=OrNone(_TIME)),
    machine=MapOf(
        Machine,
        memory_bytes=_COUNT,
        available_bytes=OrNone(_COUNT),
        processor_share=Real(1e6),
        threads=_COUNT,
        battery=OrNone(Real(1.0)),
        discharging=Flag(),
    ),
    drops=ManyOf(MapOf(Drops, of=_NAME, count=_COUNT), most=MOST_ROWS),
    troubles=ManyOf(MapOf(Trouble, about=_NAME, what=_LINE, since_s=_TIME, to_do=_LINE, urgent=Flag()), most=MOST_ROWS),
)


def plain_of(report: HealthReport) -> dict[str, Any]:
    """Maps, lists, texts and numbers; texts are cut and tidied as `report_of` wants them, none of it is infinite."""
    plain: dict[str, Any] = plainly(report, _REPORT)
    return plain


def report_of(plain: object) -> HealthReport:
    """The report that was told. Raises WireError."""
    report: HealthReport = _REPORT("the health report", plain)
    return report
