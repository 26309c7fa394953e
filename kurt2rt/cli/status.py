"""`kurt2rt status`."""

import json as json_lines
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from config.errors import ExitCode
from kurt2rt.channel.protocol.health import HEALTH, HealthReport
from kurt2rt.channel.protocol.health_text import URGENT, WARNS, headline, rows_of, trouble_in
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.options import SettingsName, task_option
from kurt2rt.platform.text_table import Column, TextTable, print_whole
from kurt2rt.service.health.status_socket import read_reports, status_socket_path
from kurt2rt.service.settings import load_service

_PATIENCE_S = 5.0
_STYLES = {WARNS: "yellow", URGENT: "bold red"}


@dataclass(frozen=True, slots=True)
class _Options:
    knowledge: Annotated[
        Path | None,
        typer.Argument(help="Knowledge file of the robot program. Default: as the settings say."),
    ] = None
    task: Annotated[str | None, task_option("That of the robot program, if no file is given.")] = None
    settings: SettingsName = "default"
    watch: Annotated[bool, typer.Option("--watch", help="Go on, once a second, until Ctrl-C.")] = False
    json: Annotated[
        bool, typer.Option("--json", help="Print the report as JSON, for programs; with --watch a line each second.")
    ] = False


@takes_options(_Options)
def status(options: _Options) -> None:
    """Tell how a running robot program is.

    Ask from another terminal. It shows how late ticks begin, how old the sensor
    readings are, and the state of bus and disk. For each trouble it shows since
    when it lasts and what to do.

        kurt2rt status
        kurt2rt status --watch

    The robot program keeps its status next to its knowledge file, for its own
    user and root. Ends with code 1 if something urgent is wrong: the robot
    stands because of it, or lessons are at risk. Ends with code 2 if no robot
    program runs.
    """
    knowledge = options.knowledge
    if knowledge is None:
        knowledge = Path(load_service(options.settings).knowledge)
        if options.task is not None:
            from kurt2rt.core.task_settings import load_task

            knowledge = knowledge.with_name(f"{load_task(options.task).name}.knowledge")
    elif not knowledge.name:
        raise typer.BadParameter("is a folder; give the knowledge file that the robot program was started with")
    reports = read_reports(status_socket_path(knowledge), _PATIENCE_S)
    newest = _show(reports, watch=options.watch, json=options.json)
    if newest.urgent:
        raise typer.Exit(ExitCode.FAILED)


def _show(reports: Iterator[HealthReport], *, watch: bool, json: bool) -> HealthReport:
    """Show the first report, or with `watch` each one until Ctrl-C; return the newest."""
    newest = next(reports)
    later = reports if watch else iter(())
    with suppress(KeyboardInterrupt):
        if json:
            typer.echo(_line(newest))
            for newest in later:
                typer.echo(_line(newest))
        elif watch:
            with Live(as_rich(newest), auto_refresh=False) as live:
                for newest in later:
                    live.update(as_rich(newest), refresh=True)
        else:
            print_whole(Console(), as_rich(newest))
    return newest


def as_rich(report: HealthReport) -> Group:
    """Return the report as a table for the terminal, with its troubles below."""
    table = TextTable(Column("", whole=True), "")
    for row in rows_of(report):
        style = _STYLES.get(row.level, "")
        table.add_row(Text(row.name, style=style or "bold"), Text(row.text, style=style))
    for link in report.pages:
        table.add_row(Text("page", style="bold"), Text(link))
    told = [Text(f"! {trouble_in(each)}", style=_STYLES[URGENT if each.urgent else WARNS]) for each in report.troubles]
    style = _STYLES[URGENT] if report.urgent else _STYLES[WARNS] if report.troubles else "green"
    return Group(Text(headline(report), style=style), table, *told)


def _line(report: HealthReport) -> str:
    return json_lines.dumps(HEALTH.plain_of(report))
