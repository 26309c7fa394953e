"""The report: a table for people, JSON for programs."""

import io
import json
import re
from typing import Literal

from rich.console import Console

from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode
from kurt2rt.checks.doctor.finding_text import text_of
from kurt2rt.checks.doctor.report import as_json, print_report, summary

FINE = CheckResult(FindingCode.PYTHON, CheckStatus.OK, {"version": "3.11.7"}, needed=True)
SLOW = CheckResult(FindingCode.SPACE_LOW, CheckStatus.WARNING, {"free_gb": 0.5}, needed=True)
NO_CAN = CheckResult(
    FindingCode.CAN_INTERFACE_NONE,
    CheckStatus.MISSING,
    {"folder": "[net]", "up": "sudo ip link set can0 up type can bitrate 1000000"},
)
NO_DISK = CheckResult(
    FindingCode.FOLDER_UNWRITABLE, CheckStatus.MISSING, {"folder": "/x", "error": "full"}, needed=True
)


def printed(*findings: CheckResult, width: int = 120, colours: Literal["standard"] | None = None) -> str:
    text = io.StringIO()
    # The terminal that the tests run in must not matter.
    console = Console(file=text, width=width, color_system=colours, force_terminal=colours is not None, no_color=False)
    print_report(findings, console)
    return text.getvalue()


def test_the_summary_counts_and_names_what_run_cannot_do_without() -> None:
    assert re.findall(r"\b\d+\b", summary([FINE, SLOW, NO_CAN])) == ["3", "1", "1", "1"]
    assert summary([NO_CAN, NO_DISK]).endswith(f": {text_of(NO_DISK).subject}")


def test_the_summary_is_the_last_line() -> None:
    assert printed(FINE, NO_CAN).splitlines()[-1] == summary([FINE, NO_CAN])


def test_brackets_in_what_was_found_are_no_markup() -> None:
    assert "[net]" in printed(NO_CAN)


def test_a_line_to_copy_stays_one_line_on_a_narrow_screen() -> None:
    assert f"{text_of(NO_CAN).subject}: {text_of(NO_CAN).what_to_do}" in printed(NO_CAN, width=40).splitlines()


def test_the_status_has_a_colour_of_its_own() -> None:
    report = printed(FINE, SLOW, NO_CAN, colours="standard")
    for coloured in ("\x1b[32mok", "\x1b[33mwarning", "\x1b[1;31mmissing"):
        assert coloured in report


def test_json_holds_everything() -> None:
    assert json.loads(as_json([NO_CAN, FINE])) == [
        {
            "code": "can interface none",
            "subject": "CAN interface",
            "status": "missing",
            "found": text_of(NO_CAN).found,
            "what_to_do": text_of(NO_CAN).what_to_do,
            "needed": False,
        },
        {"code": "python", "subject": "Python", "status": "ok", "found": "3.11.7", "what_to_do": "", "needed": True},
    ]
