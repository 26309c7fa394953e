"""Checks, report and picture of a soak."""

import json
import re
from pathlib import Path

import pytest
from rich.console import Console

from kurt2rt.checks.faults.complaint import Complaint, ComplaintCode, complaint, text_of
from kurt2rt.checks.soak.checks import fault_check, format_memory_growth, memory_check, starts_check, steady_check
from kurt2rt.checks.soak.faults import FaultResult
from kurt2rt.checks.soak.picture import draw_soak
from kurt2rt.checks.soak.report import as_json, print_report
from kurt2rt.checks.soak.result import CheckCode, SoakCheck, SoakMinute, SoakResult, SoakStart
from tests.checks.soak.helpers import DAY

LIMITS = DAY.limits


def minute(number: int, resident_mb: float = 100.0, open_files: int = 14, threads: int = 2) -> SoakMinute:
    mood = "patient" if number % 7 else "away"
    return SoakMinute(
        60.0 * number, resident_mb, open_files, threads, 60, 200 + number, 0.8, 0.1, 0.1, 0.01, number % 3, mood
    )


def hours(count: float, grown_mb_per_hour: float) -> list[SoakMinute]:
    """Return minutes in which memory grows evenly."""
    return [minute(number, 100.0 + grown_mb_per_hour * number / 60.0) for number in range(1, round(60 * count) + 1)]


def fault(*complaints: Complaint, drove: bool = True, stood_after_s: float | None = 0.05) -> FaultResult:
    return FaultResult(100.0, "encoders", "off", drove, stood_after_s, None, complaints)


TOO_FAST = complaint(ComplaintCode.TOO_FAST, 5.0, speed_m_s=0.7)
DROVE = complaint(ComplaintCode.DROVE_ALL_THE_WHILE)
LOST = complaint(ComplaintCode.LESSONS_NOT_STORED, taught=3, stored=2, names="")

RESULT = SoakResult(
    name="day",
    seed=1,
    simulated_s=7200.0,
    took_s=120.0,
    ticks=719_000,
    missed_ticks=1_000,
    frames=720_000,
    checks=(
        SoakCheck(CheckCode.TEACHING_CLOCK, passed=True, values={"ticks": 0}),
        SoakCheck(CheckCode.ODOMETRY, passed=False, values={"worst_mm": 40.0}),
    ),
    minutes=tuple(hours(2, 1.0)),
    starts=(SoakStart(0.0, 3600.0, "none", ""), SoakStart(3601.0, 3599.0, "lossy", "OSError()", LOST)),
    faults=(fault(), fault(drove=False), fault(DROVE, stood_after_s=None)),
    complaints=(TOO_FAST,),
    counted={"set down": 3},
    grown_kb={"kurt2rt/core/rla/rla.py": 12.5},
)


@pytest.mark.parametrize(("grown_mb_per_hour", "passed"), [(0.0, True), (0.5, True), (1.0, False)])
def test_memory_is_held_against_the_end_of_the_first_hour(grown_mb_per_hour: float, passed: bool) -> None:
    assert memory_check(hours(8, grown_mb_per_hour), LIMITS).passed is passed


def test_memory_check_ignores_the_first_hour() -> None:
    first = [minute(number, 80.0 + min(number, 45)) for number in range(1, 61)]
    later = [minute(number, 126.0) for number in range(61, 180)]
    assert memory_check(first + later, LIMITS).values == {"limit_mb": LIMITS.memory_mb, "grown_mb": 1.0, "end_mb": 1.0}


def test_a_short_soak_is_not_asked_about_memory() -> None:
    check = memory_check(hours(1.1, 50.0), LIMITS)
    assert check.passed
    assert not check.judged


def test_memory_growth_separates_knowledge_and_leftovers() -> None:
    starts = [SoakStart(600.0 * number, 590.0, "none", "", left_mb=90.0 + 0.1 * number) for number in range(18)]
    numbers = re.findall(r"[+]?\d[\d.]*", format_memory_growth(hours(3, 1.0), starts))
    assert numbers == ["+2.0", "+1.2", "12", "+0.8", "+124", "+0", "6.5"]


def test_a_soak_of_one_program_has_nothing_to_tell_apart() -> None:
    assert format_memory_growth(hours(3, 1.0), [SoakStart(0.0, 10_800.0, "none", "", left_mb=90.0)]) == ""
    assert format_memory_growth(hours(0.5, 1.0), [SoakStart(0.0, 600.0, "none", "", left_mb=90.0)] * 3) == ""


def test_files_and_threads_that_become_more_are_seen() -> None:
    assert steady_check(hours(1, 0.0)).passed
    leaks = [minute(number, open_files=14 + number // 10) for number in range(1, 61)]
    assert not steady_check(leaks).passed
    assert not steady_check([minute(1), *(minute(number, threads=3) for number in range(2, 30))]).passed


def test_one_file_that_is_open_for_a_moment_is_none_that_leaks() -> None:
    assert steady_check([*hours(1, 0.0), minute(61, open_files=15)]).passed


def test_one_fault_that_led_elsewhere_is_enough() -> None:
    assert fault_check([fault(), fault()]).passed
    assert fault_check([fault(), fault(DROVE)]) == SoakCheck(
        CheckCode.FAULTS, passed=False, values={"faults": 2, "drove": 2, "wrong": 1}
    )


def test_starts_check_unexpected_end_or_lost_lesson_fails() -> None:
    well = SoakStart(0.0, 100.0, "none", "")
    assert starts_check([well, well._replace(ended_by="a fault")], []).passed
    assert not starts_check([well], [complaint(ComplaintCode.ENDED_UNEXPECTEDLY, 3.0, error="KeyError()")]).passed
    assert not starts_check([well._replace(complaint=LOST)], []).passed


def test_the_report_says_what_did_not_hold() -> None:
    console = Console(width=120, record=True, quiet=False, file=None, force_terminal=False)
    with console.capture() as capture:
        print_report(RESULT, console)
    said = capture.get()
    assert "NO" in said
    for each in (text_of(TOO_FAST), f"encoders off: {text_of(DROVE)}", f"at 3601.000 s: {text_of(LOST)}", "+12.5 kB"):
        assert each in said


def test_json_has_everything_by_name() -> None:
    content = json.loads(as_json(RESULT))
    assert content["passed"] is False
    assert content["faults"][2]["codes"] == [ComplaintCode.DROVE_ALL_THE_WHILE]
    assert content["starts"][1]["wire"] == "lossy"
    assert len(content["minutes"]) == 120
    assert content["checks"][1]["code"] == CheckCode.ODOMETRY
    assert content["checks"][1]["passed"] is False


def test_the_picture_is_drawn(tmp_path: Path) -> None:
    path = tmp_path / "soak.png"
    draw_soak(RESULT, LIMITS, path)
    assert path.read_bytes().startswith(b"\x89PNG")
