"""Complaints of fault drills and soaks: a code with its numbers, and a text for each."""

from collections.abc import Mapping
from enum import StrEnum
from typing import NamedTuple

Value = float | str


class ComplaintCode(StrEnum):
    """Deviation from the row of a fault table, from the motion envelope or from a complete log."""

    STOOD = "stood"
    DID_NOT_STAND = "did not stand"
    STOOD_LATE = "stood late"
    STOOD_FOR_ANOTHER_CAUSE = "stood for another cause"
    DID_NOT_GO_ON = "did not go on"
    OTHER_LATCH = "other latch"
    LATCHED_LATE = "latched late"
    DID_NOT_DRIVE_BY_ITSELF = "did not drive by itself"
    DROVE_BY_ITSELF = "drove by itself"
    DID_NOT_DRIVE_WHEN_TOLD = "did not drive when told"
    OLD_FRAMES = "old frames"
    NOT_COUNTED = "not counted"
    LOG_LOST_FRAMES = "log lost frames"
    GAP_CLOSED = "gap closed"
    LESSONS_NOT_STORED = "lessons not stored"
    LESSONS_NOT_ACKNOWLEDGED = "lessons not acknowledged"
    LOG_MISCOUNTED = "log miscounted"
    DROVE_ALL_THE_WHILE = "drove all the while"
    UNKNOWN_FRAME = "unknown frame"
    OLD_COMMAND = "old command"
    NO_BRAKE = "no brake"
    ARRIVED_TWICE = "arrived twice"
    TOO_FAST = "too fast"
    TURNED_ROUND = "turned round"
    JUMPED = "jumped"
    DROVE_THOUGH = "drove though"
    DROVE_UNTOLD = "drove untold"
    TICKS_UNACCOUNTED = "ticks unaccounted"
    OFF_DEADLINE = "off deadline"
    ENDED_UNEXPECTEDLY = "ended unexpectedly"
    NOT_SAVED = "not saved"


class Complaint(NamedTuple):
    """One deviation."""

    code: ComplaintCode
    values: Mapping[str, Value]
    """Fields of the code's text."""
    at_s: float | None = None
    """Simulated time; None for the whole of a drill."""


def complaint(code: ComplaintCode, at_s: float | None = None, **values: Value) -> Complaint:
    """Return a complaint of a code at a simulated time in s (None: of no moment), with the values of its text."""
    return Complaint(code, values, at_s)


_TEXTS: Mapping[ComplaintCode, str] = {
    ComplaintCode.STOOD: "must drive on, stood for {stood_s:.2f} s because of {because}",
    ComplaintCode.DID_NOT_STAND: "must stand because of {must}, did not",
    ComplaintCode.STOOD_LATE: "must stand within {must_ms:.0f} ms, took {after_ms:.1f}",
    ComplaintCode.STOOD_FOR_ANOTHER_CAUSE: "must stand because of {must}, stood because of {because}",
    ComplaintCode.DID_NOT_GO_ON: "must go on in between, stood to the end of the fault",
    ComplaintCode.OTHER_LATCH: "must stay stopped because of {must}, it was {latched}",
    ComplaintCode.LATCHED_LATE: "must be stopped for good within {must_s:g} s, took {after_s:.3f}",
    ComplaintCode.DID_NOT_DRIVE_BY_ITSELF: "must drive by itself when the fault is over, did not",
    ComplaintCode.DROVE_BY_ITSELF: "must wait for {must} when the fault is over, drove by itself",
    ComplaintCode.DID_NOT_DRIVE_WHEN_TOLD: "must drive after {must}, did not",
    ComplaintCode.OLD_FRAMES: "{frames} old set points arrived at the robot, allowed are {allowed}",
    ComplaintCode.NOT_COUNTED: "no {counter} were counted",
    ComplaintCode.LOG_LOST_FRAMES: "the log must lose nothing, lost {frames} frames",
    ComplaintCode.GAP_CLOSED: "the known gap is closed: take it out of the table",
    ComplaintCode.LESSONS_NOT_STORED: "{taught} lessons were taught, the file holds {stored}{names}",
    ComplaintCode.LESSONS_NOT_ACKNOWLEDGED: "{saved} lessons were saved, {acknowledged} were said to be",
    ComplaintCode.LOG_MISCOUNTED: "{noted} frames passed, {written} were written and {lost} lost",
    ComplaintCode.DROVE_ALL_THE_WHILE: "must stand, drove all the while",
    ComplaintCode.UNKNOWN_FRAME: "no set point and no brake: {payload}",
    ComplaintCode.OLD_COMMAND: "a command {age_ms:.1f} ms old",
    ComplaintCode.NO_BRAKE: "no brake though the robot is to stay stopped",
    ComplaintCode.ARRIVED_TWICE: "frame {frame} arrives twice, or after {others} others",
    ComplaintCode.TOO_FAST: "{speed_m_s:.2f} m/s",
    ComplaintCode.TURNED_ROUND: "{side} turns round from {from_m_s:.2f} to {to_m_s:.2f} m/s without a rest",
    ComplaintCode.JUMPED: (
        "{side} from {from_m_s:.2f} to {to_m_s:.2f} m/s in {within_ms:.0f} ms, allowed are {allowed_m_s:.3f} m/s"
    ),
    ComplaintCode.DROVE_THOUGH: "drives though {cause}",
    ComplaintCode.DROVE_UNTOLD: "drives though {must_stand}, without a resume",
    ComplaintCode.TICKS_UNACCOUNTED: "tick {tick}: {done} done and {missed} missed are not as many",
    ComplaintCode.OFF_DEADLINE: "tick {tick} is {late_s:.6f} s off its deadline",
    ComplaintCode.ENDED_UNEXPECTEDLY: "{error}",
    ComplaintCode.NOT_SAVED: "{error}",
}


def text_of(complaint: Complaint) -> str:
    """Return the complaint as a line for the terminal."""
    text = _TEXTS[complaint.code].format(**complaint.values)
    return text if complaint.at_s is None else f"at {complaint.at_s:.3f} s: {text}"
