"""The doctor's report, for people and for programs."""

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict

from rich.console import Console
from rich.text import Text

from kurt2rt.doctor.finding import Finding, Status
from kurt2rt.text_table import TextTable, print_whole

_STYLES = {Status.OK: "green", Status.WARNING: "yellow", Status.MISSING: "bold red"}


def as_json(findings: Sequence[Finding]) -> str:
    """A JSON list with one object per finding."""
    return json.dumps([asdict(finding) for finding in findings], indent=2)


def print_report(findings: Sequence[Finding], console: Console) -> None:
    """Table of what was found, then what to do, then the summary."""
    table = TextTable("subject", "status", "found")
    for finding in findings:
        table.add_row(Text(finding.subject), Text(finding.status, style=_STYLES[finding.status]), Text(finding.found))
    print_whole(console, table, "")
    # Beneath the table and unwrapped, since most of it is there to be copied into a shell.
    for finding in findings:
        if finding.what_to_do:
            label = Text(finding.subject, style=_STYLES[finding.status])
            console.print(Text.assemble(label, f": {finding.what_to_do}"), soft_wrap=True)
    console.print(Text(summary(findings)), soft_wrap=True)


def summary(findings: Sequence[Finding]) -> str:
    """One line: how many are how, and whether `kurt2rt run` can do with it."""
    counts = Counter(finding.status for finding in findings)
    numbers = ", ".join(f"{counts[status]} {status}" for status in Status)
    wanting = ", ".join(finding.subject for finding in findings if finding.forbids_run)
    verdict = f"kurt2rt run cannot do without: {wanting}" if wanting else "kurt2rt run can start"
    return f"{len(findings)} checks: {numbers}; {verdict}"
