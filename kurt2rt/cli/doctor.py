"""`kurt2rt doctor`."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from hal.errors import ExitCode
from kurt2rt.checks.doctor.checks import run_checks
from kurt2rt.checks.doctor.report import as_json, print_report
from kurt2rt.cli.json_output import AsJson
from kurt2rt.cli.tables import console_of


def doctor(
    folder: Annotated[Path, typer.Option(help="The folder where knowledge is kept.")] = Path("var"),
    json: AsJson = False,
    ticks: Annotated[
        int,
        typer.Option(metavar="N", min=1, help="Ticks to time; each takes 20 ms, and more of them find rarer lateness."),
    ] = 100,
) -> None:
    """Check what this machine offers the robot, and what to do.

    Measures how late the timer is compared with asyncio.sleep, and how long the
    disk takes to keep a lesson; looks at clock, real-time priority, memory lock,
    cores, CAN, SQLite and the simulator's packages. Changes nothing, and needs
    neither a robot nor a display.

    Ends with code 1 only if something is missing that kurt2rt run cannot do
    without: Python, the timer, or a disk to keep knowledge on. CAN is not among
    them, for the simulated robot needs none.

    For example:

        kurt2rt doctor
    """
    with Console(stderr=True).status("looking at this machine ..."):
        findings = run_checks(folder, ticks)
    if json:
        typer.echo(as_json(findings))
    else:
        print_report(findings, console_of())
    if any(finding.forbids_run for finding in findings):
        raise typer.Exit(ExitCode.FAILED)
