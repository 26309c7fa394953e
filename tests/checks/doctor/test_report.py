"""The report: a table for people, JSON for programs."""

import io
import json
from typing import Literal

from rich.console import Console

from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode
from kurt2rt.checks.doctor.finding_text import text_of
from kurt2rt.checks.doctor.report import as_json, print_report

FINE = CheckResult(FindingCode.PYTHON, CheckStatus.OK, {"version": "3.11.7"}, needed=True)
SLOW = CheckResult(FindingCode.SPACE_LOW, CheckStatus.WARNING, {"free_gb": 0.5}, needed=True)
NO_CAN = CheckResult(
    FindingCode.CAN_INTERFACE_NONE,
    CheckStatus.MISSING,
    {"folder": "[net]", "up": "sudo ip link set can0 up type can bitrate 1000000"},
)


def printed(*findings: CheckResult, width: int = 120, colours: Literal["standard"] | None = None) -> str:
    text = io.StringIO()
    # The terminal that the tests run in must not matter.
    console = Console(file=text, width=width, color_system=colours, force_terminal=colours is not None, no_color=False)
    print_report(findings, console)
    return text.getvalue()


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
