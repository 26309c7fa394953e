"""Texts of a soak's checks for the terminal."""

from collections.abc import Mapping
from typing import NamedTuple

from kurt2rt.checks.soak.result import CheckCode, SoakCheck


class _Texts(NamedTuple):
    what: str
    found: str
    too_short: str = ""


_TEXTS: Mapping[CheckCode, _Texts] = {
    CheckCode.ENVELOPE: _Texts(
        "the motion envelope holds, the robot stands until it is told to drive, and every tick is accounted for",
        "{complaints} complaints about {frames} frames",
    ),
    CheckCode.FAULTS: _Texts(
        "every fault leads to what it must", "{faults} faults, {drove} of them while it drove; {wrong} not as they must"
    ),
    CheckCode.STARTS: _Texts(
        "every lesson is kept over every start, and nothing ends the program that must not",
        "{starts} starts, {ended} ended by a fault; {unexpected} unexpected ends, {lost} lost lessons",
    ),
    CheckCode.MEMORY: _Texts(
        "memory grows by no more than {limit_mb:g} MB after the first hour",
        "{grown_mb:+.1f} MB at most, {end_mb:+.1f} MB at the end",
        "shorter than an hour and ten minutes: not asked",
    ),
    CheckCode.FILES_AND_THREADS: _Texts(
        "open files and threads do not become more",
        "{first_files} files and {first_threads} threads first, {files} and {threads} at the end",
        "shorter than two minutes: not asked",
    ),
    CheckCode.WAITING: _Texts(
        "what waits for a tick stays little", "{commands} commands at most, {allowed} are allowed"
    ),
    CheckCode.ODOMETRY: _Texts("encoders and wheels agree", "{worst_mm:.1f} mm at most in a minute"),
    CheckCode.RECORDED: _Texts("every tick is recorded", "{recorded} of {ticks}, {lost} notes lost{trouble}"),
    CheckCode.TEACHING_CLOCK: _Texts("the teaching clock does not drift", "{ticks} ticks off"),
}


def property_text(check: SoakCheck) -> str:
    """Return the property that must hold."""
    return _TEXTS[check.code].what.format(**check.values)


def found_text(check: SoakCheck) -> str:
    """Return the measured numbers."""
    texts = _TEXTS[check.code]
    return texts.found.format(**check.values) if check.judged else texts.too_short
