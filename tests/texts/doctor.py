"""Listings of the texts of the doctor's findings, and of its summary."""

from collections.abc import Iterator

from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode
from kurt2rt.cli.doctor import summary

_VALUES: dict[str, float | str] = {
    "version": "3.11.7",
    "name": "can0",
    "used_for": "tables",
    "fault": "no module",
    "python": "/bin/python",
    "extra": "simulation",
    "ticks": 100,
    "period_ms": 10.0,
    "median_ms": 0.1,
    "worst_ms": 0.2,
    "error": "refused",
    "usable": 1,
    "cores": 4,
    "governors": "performance on 2 cores",
    "folder": "/x",
    "parent": "/",
    "free_gb": 0.5,
    "times": 20,
    "limit_ms": 20.0,
    "up": "sudo ip link set can0 up",
}


def findings() -> Iterator[tuple[str, str]]:
    """Yield subject, found and what to do of each finding."""
    for code in FindingCode:
        finding = CheckResult(code, CheckStatus.OK, _VALUES)
        yield code, " | ".join((finding.subject, finding.found, finding.what_to_do))


def summaries() -> Iterator[tuple[str, str]]:
    """Yield the last line of the report, of a machine that can run the robot program and of one that cannot."""
    fine = CheckResult(FindingCode.SQLITE_LOG, CheckStatus.OK, needed=True)
    no_folder = CheckResult(FindingCode.FOLDER_UNWRITABLE, CheckStatus.MISSING, _VALUES, needed=True)
    yield "can start", summary([fine])
    yield "cannot start", summary([fine, no_folder])
