"""`kurt2rt doctor`."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.text import Text

from config.errors import ExitCode
from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus
from kurt2rt.checks.doctor.checks import run_checks
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.tables import console_of
from kurt2rt.platform.text_table import TextTable, print_whole

_STYLES = {CheckStatus.OK: "green", CheckStatus.WARNING: "yellow", CheckStatus.MISSING: "bold red"}


def doctor(
    folder: Annotated[Path, typer.Option(help="The folder where knowledge is kept.")] = Path("var"),
    as_json: AsJson = False,
    ticks: Annotated[
        int,
        typer.Option(metavar="N", min=1, help="Ticks to time; each takes 10 ms, and more of them find rarer lateness."),
    ] = 100,
) -> None:
    """Check what this machine offers the robot, and what to do.

    Measures how late the timer is, and how long the disk takes to save a lesson.
    Checks real-time priority, cores, CAN, SQLite and the simulator's packages.
    Changes nothing, and needs neither a robot nor a display.

    Ends with code 1 only if kurt2rt run cannot work here: without the timer, or
    a disk for knowledge. CAN is not needed: the simulated robot does without.

    For example:

        kurt2rt doctor
    """
    with Console(stderr=True).status("looking at this machine ..."):
        findings = run_checks(folder, ticks)
    if as_json:
        told = ("code", "subject", "status", "found", "what_to_do", "needed")
        print_json([{key: getattr(finding, key) for key in told} for finding in findings])
    else:
        print_report(findings, console_of())
    if any(finding.forbids_run for finding in findings):
        raise typer.Exit(ExitCode.FAILED)


def print_report(findings: Sequence[CheckResult], console: Console) -> None:
    """Print the findings, the instructions and the summary."""
    table = TextTable("subject", "status", "found")
    for finding in findings:
        status = Text(finding.status, style=_STYLES[finding.status])
        table.add_row(Text(finding.subject), status, Text(finding.found))
    print_whole(console, table, "")
    # Beneath the table and unwrapped, since most of it is there to be copied into a shell.
    for finding in findings:
        if finding.what_to_do:
            label = Text(finding.subject, style=_STYLES[finding.status])
            console.print(Text.assemble(label, f": {finding.what_to_do}"), soft_wrap=True)
    console.print(Text(summary(findings)), soft_wrap=True)


def summary(findings: Sequence[CheckResult]) -> str:
    """Return the number of findings by status, and whether `kurt2rt run` can start."""
    counts = Counter(finding.status for finding in findings)
    numbers = ", ".join(f"{counts[status]} {status}" for status in CheckStatus)
    wanting = ", ".join(finding.subject for finding in findings if finding.forbids_run)
    verdict = f"kurt2rt run cannot do without: {wanting}" if wanting else "kurt2rt run can start"
    return f"{len(findings)} checks: {numbers}; {verdict}"
