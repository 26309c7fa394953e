"""The report: a table for people, JSON for programs."""

import io
from typing import Literal

from rich.console import Console

from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode
from kurt2rt.checks.doctor.report import print_report

FINE = CheckResult(FindingCode.PYTHON, CheckStatus.OK, {"version": "3.11.7"}, needed=True)
SLOW = CheckResult(FindingCode.SPACE_LOW, CheckStatus.WARNING, {"free_gb": 0.5}, needed=True)


def printed(*findings: CheckResult, width: int = 120, colours: Literal["standard"] | None = None) -> str:
    text = io.StringIO()
    # The terminal that the tests run in must not matter.
    console = Console(file=text, width=width, color_system=colours, force_terminal=colours is not None, no_color=False)
    print_report(findings, console)
    return text.getvalue()
