"""Report of the doctor for the terminal and as JSON."""

import json
from collections import Counter
from collections.abc import Sequence

from rich.console import Console
from rich.text import Text

from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus
from kurt2rt.checks.doctor.finding_text import text_of
from kurt2rt.platform.text_table import TextTable, print_whole

_STYLES = {CheckStatus.OK: "green", CheckStatus.WARNING: "yellow", CheckStatus.MISSING: "bold red"}


def as_json(findings: Sequence[CheckResult]) -> str:
    """Return a JSON list with one object per finding."""
    return json.dumps([_row(finding) for finding in findings], indent=2)


def _row(finding: CheckResult) -> dict[str, object]:
    text = text_of(finding)
    return {
        "code": finding.code,
        "subject": text.subject,
        "status": finding.status,
        "found": text.found,
        "what_to_do": text.what_to_do,
        "needed": finding.needed,
    }


def print_report(findings: Sequence[CheckResult], console: Console) -> None:
    """Print the findings, the instructions and the summary."""
    table = TextTable("subject", "status", "found")
    for finding in findings:
        text = text_of(finding)
        table.add_row(Text(text.subject), Text(finding.status, style=_STYLES[finding.status]), Text(text.found))
    print_whole(console, table, "")
    # Beneath the table and unwrapped, since most of it is there to be copied into a shell.
    for finding in findings:
        text = text_of(finding)
        if text.what_to_do:
            label = Text(text.subject, style=_STYLES[finding.status])
            console.print(Text.assemble(label, f": {text.what_to_do}"), soft_wrap=True)
    console.print(Text(summary(findings)), soft_wrap=True)


def summary(findings: Sequence[CheckResult]) -> str:
    """Return the number of findings by status, and whether `kurt2rt run` can start."""
    counts = Counter(finding.status for finding in findings)
    numbers = ", ".join(f"{counts[status]} {status}" for status in CheckStatus)
    wanting = ", ".join(text_of(finding).subject for finding in findings if finding.forbids_run)
    verdict = f"kurt2rt run cannot do without: {wanting}" if wanting else "kurt2rt run can start"
    return f"{len(findings)} checks: {numbers}; {verdict}"
