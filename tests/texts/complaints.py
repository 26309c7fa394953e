"""Listings of the texts of fault drills and soaks."""

from collections.abc import Iterator

from kurt2rt.checks.faults.complaint import ComplaintCode, complaint, text_of
from kurt2rt.checks.soak.check_text import found_text, property_text
from kurt2rt.checks.soak.result import CheckCode, SoakCheck

_VALUES: dict[str, float | str] = {
    "stood_s": 0.25,
    "must_ms": 60.0,
    "after_ms": 72.5,
    "must_s": 0.12,
    "after_s": 0.3,
    "within_ms": 10.0,
    "must": "bus lost",
    "because": "ticks ceased",
    "latched": "bus off",
    "counter": "missed ticks",
    "frames": 3,
    "allowed": 1,
    "taught": 5,
    "stored": 4,
    "names": ": ['t-1']",
    "saved": 5,
    "acknowledged": 4,
    "noted": 9,
    "written": 7,
    "lost": 1,
    "payload": "00 01",
    "age_ms": 21.0,
    "frame": 7,
    "others": 2048,
    "speed_m_s": 0.61,
    "side": "left",
    "from_m_s": 0.1,
    "to_m_s": 0.13,
    "allowed_m_s": 0.025,
    "cause": "stopped",
    "must_stand": "bus lost",
    "tick": 12,
    "done": 11,
    "missed": 2,
    "late_s": 0.0101,
    "error": "KeyError()",
}
_CHECK_VALUES: dict[str, float | str] = {
    "complaints": 1,
    "frames": 720,
    "faults": 4,
    "drove": 3,
    "wrong": 1,
    "starts": 2,
    "ended": 1,
    "unexpected": 1,
    "lost": 1,
    "limit_mb": 5.0,
    "grown_mb": 1.5,
    "end_mb": 0.5,
    "first_files": 14,
    "first_threads": 2,
    "files": 15,
    "threads": 3,
    "commands": 4,
    "allowed": 8,
    "worst_mm": 1.25,
    "recorded": 99,
    "ticks": 100,
    "trouble": "; full",
}


def complaints() -> Iterator[tuple[str, str]]:
    """Yield the text of each complaint."""
    for code in ComplaintCode:
        yield code, text_of(complaint(code, 5.0 if code is ComplaintCode.TOO_FAST else None, **_VALUES))


def soak_checks() -> Iterator[tuple[str, str]]:
    """Yield the texts of each check, judged and too short to judge."""
    for code in CheckCode:
        check = SoakCheck(code, passed=True, values=_CHECK_VALUES)
        yield code, f"{property_text(check)} | {found_text(check)}"
    for code in (CheckCode.MEMORY, CheckCode.FILES_AND_THREADS):
        yield f"{code}, too short", found_text(SoakCheck(code, passed=True, values=_CHECK_VALUES, judged=False))
