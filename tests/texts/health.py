"""Listings of the texts of troubles and of the health report."""

from collections.abc import Iterator

from kurt2rt.channel.protocol.health_text import lines_of, progress_in
from kurt2rt.channel.protocol.trouble_code import TroubleCode, trouble_text
from kurt2rt.core.progress import NO_PROGRESS, Progress
from tests.service.health.reports import ILL, WELL

_NUMBERS = {
    TroubleCode.SENSORS_SILENT: (0.64,),
    TroubleCode.SENSOR_STUCK: (294,),
    TroubleCode.SENSOR_OUT_OF_RANGE: (0,),
    TroubleCode.SENSOR_SEES_NOTHING: (70,),
    TroubleCode.SENSOR_SEES_A_PHANTOM: (551,),
    TroubleCode.TICKS_MISSED: (3, 7),
    TroubleCode.TICKS_LATE: (2.14,),
    TroubleCode.CAN_JUNK: (12,),
    TroubleCode.CAN_ERROR_FRAMES: (12,),
    TroubleCode.SEND_FAILURES: (12,),
    TroubleCode.RECEIVE_FAILURES: (12,),
    TroubleCode.FOREIGN_CONTROL: (12,),
    TroubleCode.SLOW_DISK: (0.84,),
    TroubleCode.LITTLE_ROOM: (499.2,),
    TroubleCode.LOW_BATTERY: (0.15,),
    TroubleCode.LITTLE_MEMORY: (50.4,),
    TroubleCode.DROPS: (40,),
}
_NAMES = {
    TroubleCode.SENSORS_UNHEARD: "bumpers",
    TroubleCode.SENSORS_SILENT: "range sensors",
    TroubleCode.SENSOR_STUCK: "front left edge (s15)",
    TroubleCode.SENSOR_OUT_OF_RANGE: "left front (s1)",
    TroubleCode.SENSOR_SEES_NOTHING: "front centre (s11)",
    TroubleCode.SENSOR_SEES_A_PHANTOM: "rear right (s13)",
    TroubleCode.DISK_SILENT: "knowledge",
    TroubleCode.LITTLE_ROOM: "recordings",
    TroubleCode.DROPS: "lines for the terminal",
}


def troubles() -> Iterator[tuple[str, str]]:
    """Yield what is wrong and what to do, for each code; the same on every surface."""
    for code in TroubleCode:
        what, to_do = trouble_text(code, _NAMES.get(code, ""), _NUMBERS.get(code, ()), "a line; a remedy")
        yield code, f"{what}: {to_do}" if to_do else what
    yield f"{TroubleCode.TICKS_MISSED}, one", trouble_text(TroubleCode.TICKS_MISSED, "", (1, 1), "")[0]


def reports() -> Iterator[tuple[str, str]]:
    """Yield the lines of a report of a robot that is well, that is not, and of none; and rows with other numbers."""
    for name, report in {"well": WELL, "not well": ILL, "no report yet": None}.items():
        for number, line in enumerate(lines_of(report)):
            yield f"{name} {number}", line
    for progress in (NO_PROGRESS, Progress(12, 0, 1), Progress(60, 87, 3)):
        yield f"progress, {progress.asks} questions", progress_in(progress)
