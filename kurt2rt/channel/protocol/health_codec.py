"""Codec of the health report, for JSON and CBOR."""

from typing import Any

from kurt2rt.channel.protocol.cbor_schema import COUNT, LINE, NAME, DataclassCodec, MapOf
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
from kurt2rt.channel.protocol.trouble_code import TroubleCode, numbers_of
from kurt2rt.core.teaching.message_fields import Flag, Float, ListOf, OneWord, OrNone, WireError
from kurt2rt.core.teaching.progress import Progress

MOST_ROWS = 16
"""Most troubles, disks and queues in a report; further ones are left out."""

_TIME = Float(1e12)


def _trouble(code: str, numbers: tuple[float, ...], about: str, what: str, to_do: str, **others: Any) -> Trouble:
    """Return a trouble, whose texts (`about`, `what`, `to_do`) follow from its code. Raises WireError."""
    del about, what, to_do
    trouble = TroubleCode(code)
    if len(numbers) < numbers_of(trouble):
        raise WireError(f"trouble {code!r} has to have {numbers_of(trouble)} numbers")
    return Trouble(trouble, numbers=numbers, **others)


_TROUBLE = MapOf(
    _trouble,
    about=NAME,
    what=LINE,
    since_s=_TIME,
    to_do=LINE,
    urgent=Flag(),
    code=OneWord(tuple(code.value for code in TroubleCode)),
    name=NAME,
    numbers=ListOf(_TIME, most=4),
    line=LINE,
)

_MILLISECONDS = dict.fromkeys(("newest_ms", "median_ms", "p99_ms", "worst_ms", "took_p99_ms"), _TIME)
_REPORT = MapOf(
    HealthReport,
    version=NAME,
    boot=NAME,
    robot=NAME,
    task=NAME,
    knowledge=LINE,
    started_at=NAME,
    uptime_s=_TIME,
    tick=COUNT,
    doing=LINE,
    rlas=COUNT,
    lessons=COUNT,
    punctuality=MapOf(TickLateness, **_MILLISECONDS, ticks=COUNT, missed=COUNT, missed_lately=COUNT),
    ages=MapOf(SensorAges, infrared_s=OrNone(_TIME), encoders_s=OrNone(_TIME), bumpers_s=OrNone(_TIME)),
    bus=OrNone(
        MapOf(
            BusHealth,
            controller=NAME,
            frames=COUNT,
            junk=COUNT,
            error_frames=COUNT,
            foreign_control=COUNT,
            send_failures=COUNT,
            receive_failures=COUNT,
        )
    ),
    disks=ListOf(MapOf(DiskSpace, of=NAME, free_bytes=OrNone(COUNT)), most=MOST_ROWS),
    safety=MapOf(JournalHealth, unwritten=COUNT, last_write_ms=OrNone(_TIME)),
    machine=MapOf(
        MachineHealth,
        memory_bytes=COUNT,
        available_bytes=OrNone(COUNT),
        processor_share=Float(1e6),
        threads=COUNT,
        battery=OrNone(Float(1.0)),
        discharging=Flag(),
    ),
    drops=ListOf(MapOf(Drops, of=NAME, count=COUNT), most=MOST_ROWS),
    troubles=ListOf(_TROUBLE, most=MOST_ROWS),
    progress=MapOf(Progress, seconds=COUNT, driven_percent=OrNone(COUNT), asks=COUNT),
    plugins=ListOf(LINE, most=MOST_ROWS),
)

_FORM = DataclassCodec[HealthReport]("the health report", _REPORT)
plain_of = _FORM.plain_of
report_of = _FORM.read
