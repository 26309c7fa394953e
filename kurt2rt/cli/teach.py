"""`kurt2rt teach`."""

import sys
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated

import anyio
import anyio.to_thread
import typer
from rich.console import Console

from hal.robot_settings import load_robot, robot_that_task_names
from kurt2rt.channel.security.pairing import LOCAL, OF_THIS_MACHINE, TERMINAL, Device, local_pairing, read_device
from kurt2rt.cli.no_robot import no_robot
from kurt2rt.cli.options import DEFAULT_TEACHER, PageAddressName, RobotName, Teacher, task_option
from kurt2rt.cli.scripted_file import people_agree
from kurt2rt.cli.teach_shutdown import until_teaching_ends
from kurt2rt.core.rla.rla import AUTO, PROGRAMS
from kurt2rt.core.task_settings import load_task, taught_by_named
from kurt2rt.service.settings import ServiceSettings, load_service
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.scripted.channel_teacher import teach_by_script
from kurt2rt.teacher.terminal.terminal import TerminalTeacher

_NEWEST_LESSONS = 20

_Terminal = Annotated[bool, typer.Option("--terminal", help="Teach by typing, here; no page is served.")]
_Auto = Annotated[
    bool, typer.Option("--auto", help="Let a scripted teacher teach, a simulated robot only; no page is served.")
]
_Phone = Annotated[
    bool, typer.Option("--phone", help="Serve every device: this machine and, once one is paired, the network.")
]
_Device = Annotated[
    str | None,
    typer.Option(
        help="Teach as this paired device. Default: one of this machine's own: local for the page, terminal with "
        "--terminal, auto with --auto.",
    ),
]
_Robot = Annotated[str | None, typer.Option(help="Address of the robot. Default: as noted when the device was paired.")]
_Port = Annotated[
    int | None,
    typer.Option(metavar="PORT", min=1, max=65535, help="UDP port of the robot. Default: as noted with the pairing."),
]
_PagePort = Annotated[
    int | None,
    typer.Option(
        metavar="PORT",
        min=0,
        max=65535,
        help="TCP port of the page; 0: any. Default: as the settings say, or one of the next nine if another page has "
        "that.",
    ),
]
_PublicAddress = Annotated[
    str | None, typer.Option(help="Address of a TLS proxy in front of the page, such as https://robot.example.")
]
_Task = Annotated[str | None, task_option("Taught by the scripted teacher. Default: the task of the settings.")]
_Seed = Annotated[int, typer.Option(metavar="N", min=0, help="Seed of the scripted teacher.")]
_Settings = Annotated[str, typer.Option(help="Runtime settings by name (config/runtime) or a path to a YAML file.")]
_WhileStdin = Annotated[
    bool, typer.Option("--while-stdin", hidden=True, help="End with the standard input, as kurt2rt run needs it.")
]
_AsJson = Annotated[bool, typer.Option("--pages-as-json", hidden=True)]


def teach(
    terminal: _Terminal = False,
    auto: _Auto = False,
    phone: _Phone = False,
    device: _Device = None,
    robot: _Robot = None,
    port: _Port = None,
    page_port: _PagePort = None,
    page_address: PageAddressName = None,
    public_address: _PublicAddress = None,
    task: _Task = None,
    teacher: Teacher = DEFAULT_TEACHER,
    robot_settings: RobotName = None,
    seed: _Seed = 1,
    settings: _Settings = "default",
    while_stdin: _WhileStdin = False,
    pages_as_json: _AsJson = False,
) -> None:
    """Teach a running robot: by browser, terminal or script.

    Start the robot in another terminal, then open the address that this prints:

        kurt2rt run
        kurt2rt teach

    For a phone, pair it once and scan the code; kurt2rt run --phone does both:

        kurt2rt pair phone
        kurt2rt teach --phone

    On another machine than the robot, for the device whose folder is there:

        kurt2rt teach --device phone --robot 192.168.0.7

    With --terminal, an action answers or corrects, Enter alone stops the robot,
    help shows the rest. Page and terminal wait for a robot that is not there yet.
    With --auto, a simulated robot is taught for as long as the task says.

    Ends on Ctrl-C. A robot that was driven by hand from the page is stopped;
    after --terminal and --auto it is stopped in any case.
    """
    _run(_Arguments(**locals()))


@dataclass(frozen=True, slots=True)
class _Arguments:
    terminal: bool
    auto: bool
    phone: bool
    device: str | None
    robot: str | None
    port: int | None
    page_port: int | None
    page_address: str | None
    public_address: str | None
    task: str | None
    teacher: str
    robot_settings: str | None
    seed: int
    settings: str
    while_stdin: bool
    pages_as_json: bool

    def check(self) -> None:
        """Raise typer.BadParameter if options contradict each other."""
        if self.terminal and self.auto:
            raise typer.BadParameter("one teacher at a time: --terminal or --auto", param_hint="--auto")
        others = (self.terminal, self.auto, self.device, self.robot, self.public_address)
        if self.phone and any(each not in (False, None) for each in others):
            raise typer.BadParameter(
                "it serves the pages of all devices, on the robot's machine; leave out --terminal, --auto, --device, "
                "--robot and --public-address",
                param_hint="--phone",
            )


@dataclass(frozen=True, slots=True)
class _Route:
    """Address of the robot, and the device that teaches it."""

    device: Device
    host: str
    port: int


def _run(arguments: _Arguments) -> None:
    arguments.check()
    service = load_service(arguments.settings)
    if arguments.phone:
        _serve(arguments, service, None)
        return
    device = _device(
        service, arguments.device or (TERMINAL if arguments.terminal else AUTO if arguments.auto else LOCAL)
    )
    route = _Route(device, arguments.robot or device.host, arguments.port or device.port)
    if arguments.terminal:
        _teach(route, partial(_by_typing, route), while_stdin=False)
    elif arguments.auto:
        _teach(route, partial(_by_script, route, service, arguments), while_stdin=arguments.while_stdin)
    else:
        _serve(arguments, service, route)


def _serve(arguments: _Arguments, service: ServiceSettings, route: _Route | None) -> None:
    """Serve the page of one device, or without a route those of all."""
    # Imported here: the packages of the page are an extra, which the robot's own machine may lack.
    from kurt2rt.cli.teach_page import SPARE_PORTS, PageOptions, serve_page, serve_pages

    page_port = arguments.page_port
    options = PageOptions(
        port=service.page_port if page_port is None else page_port,
        spare_ports=SPARE_PORTS if page_port is None else 0,
        address=arguments.page_address or service.page_address,
        while_stdin=arguments.while_stdin,
        as_json=arguments.pages_as_json,
    )
    if route is None:
        serve_pages(service, arguments.port or service.port, options)
    else:
        serve_page(route.device, route.host, route.port, options, arguments.public_address)


def _device(service: ServiceSettings, name: str) -> Device:
    if name in OF_THIS_MACHINE:
        return local_pairing(Path(service.teachers), Path(service.devices), name, port=service.port).device
    return read_device(Path(service.devices) / name)


_Print = Callable[[str], None]


def _teach(route: _Route, teacher: Callable[[TeacherClient, _Print], Awaitable[None]], *, while_stdin: bool) -> None:
    console = Console()

    def print_line(text: str) -> None:
        console.print(text, markup=False, highlight=False, soft_wrap=True)

    async def run() -> None:
        async with (
            TeacherClient(route.device.folder, route.host, route.port) as client,
            anyio.create_task_group() as tasks,
        ):

            async def until_ended() -> None:
                reason = await until_teaching_ends(route.device, while_stdin=while_stdin)
                if reason:
                    print_line(reason)
                with anyio.move_on_after(1.0, shield=True):
                    await client.stop()
                tasks.cancel_scope.cancel()

            tasks.start_soon(until_ended)
            await teacher(client, print_line)
            tasks.cancel_scope.cancel()

    anyio.run(run)


async def _by_typing(route: _Route, client: TeacherClient, print_line: _Print) -> None:
    await TerminalTeacher(client, sys.stdin, print_line, f"{route.host}:{route.port}").teach()


async def _by_script(
    route: _Route, service: ServiceSettings, arguments: _Arguments, client: TeacherClient, print_line: _Print
) -> None:
    try:
        await client.hello()
        # With --while-stdin, kurt2rt run has asked already whether a person's file may be used.
        lessons = () if arguments.while_stdin else await client.lessons(_NEWEST_LESSONS)
    except NoAnswerError as error:
        raise no_robot(route.host, route.port, route.device.name) from error
    people = dict.fromkeys(each.teacher for each in reversed(lessons) if each.teacher not in PROGRAMS)
    instead = "run the robot on another file, or let kurt2rt run --auto do so"
    if not await anyio.to_thread.run_sync(people_agree, "the robot's knowledge", tuple(people), instead):
        return
    task = taught_by_named(load_task(arguments.task or service.task), arguments.teacher)
    name = arguments.task or service.task
    robot = load_robot(arguments.robot_settings or robot_that_task_names(name) or service.robot)
    await teach_by_script(client, robot, task, print_line, seed=arguments.seed)
