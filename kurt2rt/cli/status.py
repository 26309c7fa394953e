"""`kurt2rt status`."""

import json as json_lines
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import anyio
import anyio.from_thread
import typer
from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from hal.errors import ExitCode
from kurt2rt.channel.protocol.health import HealthReport
from kurt2rt.channel.protocol.health_codec import plain_of
from kurt2rt.channel.protocol.health_text import URGENT, WARNS, headline, rows_of, trouble_in
from kurt2rt.channel.security.pairing import Device, read_device
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.options import task_option
from kurt2rt.core.task_settings import load_task
from kurt2rt.platform.text_table import TextTable, print_whole
from kurt2rt.service.health.status_error import StatusCode, StatusError
from kurt2rt.service.health.status_socket import read_reports, status_socket_path
from kurt2rt.service.settings import load_service
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.client.observer_client import ObserverClient

_PATIENCE_S = 5.0
_STYLES = {WARNS: "yellow", URGENT: "bold red"}


@dataclass(frozen=True, slots=True)
class _Options:
    knowledge: Annotated[
        Path | None,
        typer.Argument(help="Knowledge file of the robot program. Default: as the settings say."),
    ] = None
    task: Annotated[str | None, task_option("That of the robot program, if no file is given.")] = None
    settings: Annotated[
        str, typer.Option(help="Runtime settings by name (config/runtime) or a path to a YAML file.")
    ] = "default"
    watch: Annotated[bool, typer.Option("--watch", help="Go on, once a second, until Ctrl-C.")] = False
    json: Annotated[
        bool, typer.Option("--json", help="Print the report as JSON, for programs; with --watch a line each second.")
    ] = False
    device: Annotated[
        str | None,
        typer.Option(help="Ask over the teacher's channel instead, as this paired device; from any machine."),
    ] = None
    robot: Annotated[
        str | None, typer.Option(help="With --device, address of the robot. Default: as noted with the pairing.")
    ] = None
    port: Annotated[
        int | None,
        typer.Option(
            metavar="PORT",
            min=1,
            max=65535,
            help="With --device, UDP port of the robot. Default: as noted with the pairing.",
        ),
    ] = None


@takes_options(_Options)
def status(options: _Options) -> None:
    """Tell how a running robot program is.

    Ask from another terminal, or another machine. It shows how late ticks begin,
    how old the sensor readings are, and the state of bus and disk. For each
    trouble it shows since when it lasts and what to do.

        kurt2rt status
        kurt2rt status --watch
        kurt2rt status --device phone

    The robot program keeps its status next to its knowledge file, for its own
    user and root. Ends with code 1 if something urgent is wrong: the robot
    stands because of it, or lessons are at risk. Ends with code 2 if no robot
    program runs.
    """
    if options.device is None and (options.robot is not None or options.port is not None):
        raise typer.BadParameter(
            "only the teacher's channel has an address; give --device", param_hint="--robot, --port"
        )
    service = load_service(options.settings)
    if options.device is not None:
        reports = _over_the_channel(read_device(Path(service.devices) / options.device), options.robot, options.port)
    else:
        default = Path(service.knowledge)
        if options.task is not None:
            default = default.with_name(f"{load_task(options.task).name}.knowledge")
        _require_name(options.knowledge)
        reports = read_reports(status_socket_path(options.knowledge or default), _PATIENCE_S)
    newest = _show(reports, watch=options.watch, json=options.json)
    if newest.urgent:
        raise typer.Exit(ExitCode.FAILED)


def _require_name(knowledge: Path | None) -> None:
    if knowledge is not None and not knowledge.name:
        raise typer.BadParameter("is a folder; give the knowledge file that the robot program was started with")


def _show(reports: Iterator[HealthReport], *, watch: bool, json: bool) -> HealthReport:
    newest = next(reports)
    with suppress(KeyboardInterrupt), _screen(newest, watch=watch, json=json) as show:
        for newest in reports if watch else ():
            show(newest)
    return newest


@contextmanager
def _screen(first: HealthReport, *, watch: bool, json: bool) -> Iterator[Callable[[HealthReport], None]]:
    console = Console()
    if json:
        typer.echo(_line(first))
        yield lambda report: typer.echo(_line(report))
    elif watch:
        with Live(as_rich(first), console=console, auto_refresh=False) as live:
            yield lambda report: live.update(as_rich(report), refresh=True)
    else:
        print_whole(console, as_rich(first))
        yield _nothing


def as_rich(report: HealthReport) -> Group:
    """Return the report as a table for the terminal, with its troubles below."""
    table = TextTable()
    table.add_column("", whole=True)
    table.add_column("")
    for row in rows_of(report):
        style = _STYLES.get(row.level, "")
        table.add_row(Text(row.name, style=style or "bold"), Text(row.text, style=style))
    for link in report.pages:
        table.add_row(Text("page", style="bold"), Text(link))
    told = [Text(f"! {trouble_in(each)}", style=_STYLES[URGENT if each.urgent else WARNS]) for each in report.troubles]
    return Group(Text(headline(report), style=_style_of(report)), table, *told)


def _style_of(report: HealthReport) -> str:
    return _STYLES[URGENT] if report.urgent else _STYLES[WARNS] if report.troubles else "green"


def _line(report: HealthReport) -> str:
    return json_lines.dumps(plain_of(report))


def _over_the_channel(device: Device, host: str | None, port: int | None) -> Iterator[HealthReport]:
    """Ask once a second. Raises StatusError if no robot answers, CredentialsError."""
    with anyio.from_thread.start_blocking_portal() as portal, _asking(portal, device, host, port) as client:
        last = None
        while True:
            try:
                report = portal.call(client.health)
            except NoAnswerError as error:
                address = f"{host or device.host}:{port or device.port}"
                raise StatusError(StatusCode.NO_ANSWER, address=address, device=device.name, error=error) from error
            if report is not None and report != last:
                yield report
                last = report
            portal.call(anyio.sleep, 1.0 if report is not None else 0.2)


@contextmanager
def _asking(
    portal: anyio.from_thread.BlockingPortal, device: Device, host: str | None, port: int | None
) -> Iterator[ObserverClient]:
    with portal.wrap_async_context_manager(ObserverClient(device.folder, host, port)) as client:
        portal.call(_look_away, client)
        yield client


async def _look_away(client: ObserverClient) -> None:
    """Stop reporting presence: a program that asks for the status does not watch the robot."""
    client.watching = False


def _nothing(_: HealthReport) -> None:
    pass
