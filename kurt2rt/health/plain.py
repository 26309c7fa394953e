"""The report as plain values, for JSON and CBOR, and back. Names are those of the fields."""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

from kurt2rt.channel.schema import Check, Flag, ManyOf, OrNone, Real, Text, Whole, WireError
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


class _Map:
    """A map with a check for each of its keys; unknown keys are left out, for a newer robot may tell more."""

    def __init__(self, kind: Callable[..., Any], **checks: Check) -> None:
        self.kind = kind
        self.checks = checks

    def __call__(self, what: str, value: object) -> Any:
        if not isinstance(value, Mapping):
            raise WireError(f"{what} has to be a map")
        missing = [name for name in self.checks if name not in value]
        if missing:
            raise WireError(f"{what} has no {', '.join(missing)}")
        return self.kind(**{name: check(name, value[name]) for name, check in self.checks.items()})


_MILLISECONDS = dict.fromkeys(("newest_ms", "median_ms", "p99_ms", "worst_ms", "took_p99_ms"), _TIME)
_REPORT = _Map(
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
    punctuality=_Map(Punctuality, **_MILLISECONDS, ticks=_COUNT, missed=_COUNT, missed_lately=_COUNT),
    ages=_Map(SensorAges, infrared_s=OrNone(_TIME), encoders_s=OrNone(_TIME), bumpers_s=OrNone(_TIME)),
    bus=OrNone(
        _Map(
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
    disks=ManyOf(_Map(DiskSpace, of=_NAME, free_bytes=OrNone(_COUNT)), most=MOST_ROWS),
    safety=_Map(Safety, unwritten=_COUNT, last_write_ms=OrNone(_TIME)),
    machine=_Map(
        Machine,
        memory_bytes=_COUNT,
        available_bytes=OrNone(_COUNT),
        processor_share=Real(1e6),
        threads=_COUNT,
        battery=OrNone(Real(1.0)),
        discharging=Flag(),
    ),
    drops=ManyOf(_Map(Drops, of=_NAME, count=_COUNT), most=MOST_ROWS),
    troubles=ManyOf(_Map(Trouble, about=_NAME, what=_LINE, since_s=_TIME, to_do=_LINE, urgent=Flag()), most=MOST_ROWS),
)


def plain_of(report: HealthReport) -> dict[str, Any]:
    """Maps, lists, texts and numbers; texts are cut and tidied as `report_of` wants them, none of it is infinite."""
    plain: dict[str, Any] = _tidied(asdict(report), _REPORT)
    return plain


def report_of(plain: object) -> HealthReport:
    """The report that was told. Raises WireError."""
    report: HealthReport = _REPORT("the health report", plain)
    return report


def _tidied(value: Any, check: Check) -> Any:
    match check:
        case _Map(checks=checks):
            return {name: _tidied(value[name], inner) for name, inner in checks.items()}
        case ManyOf(check=inner, most=most):
            return [_tidied(each, inner) for each in value[:most]]
        case OrNone(check=inner) if value is not None:
            return _tidied(value, inner)
        case Text():
            return check.cut(value)
        case _:
            return value
