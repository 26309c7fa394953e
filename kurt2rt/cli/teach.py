"""`kurt2rt teach`."""

import sys
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

import anyio
import anyio.to_thread
import typer
from rich.console import Console

from kurt2rt.channel.security.pairing import LOCAL, TERMINAL, Device, open_device
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.options import (
    DEFAULT_TEACHER,
    PageAddressName,
    RobotAddress,
    RobotName,
    RobotPort,
    SettingsName,
    Teacher,
    refuse_if,
    task_option,
)
from kurt2rt.cli.teach_shutdown import until_teaching_ends
from kurt2rt.core.rla.rla import AUTO, PROGRAMS
from kurt2rt.platform.text_table import print_lines
from kurt2rt.service.settings import ServiceSettings, load_service
from kurt2rt.teacher.client.answer import NoAnswerError, no_robot
from kurt2rt.teacher.client.client import TeacherClient

_NEWEST_LESSONS = 20


@dataclass(frozen=True, slots=True)
class _Options:
    terminal: Annotated[bool, typer.Option("--terminal", help="Teach by typing, here; no page is served.")] = False
    auto: Annotated[
        bool, typer.Option("--auto", help="Let a scripted teacher teach, a simulated robot only; no page is served.")
    ] = False
    phone: Annotated[
        bool,
        typer.Option("--phone", help="Serve every device: this machine and, once one is paired, the network."),
    ] = False
    device: Annotated[
        str | None,
        typer.Option(
            help="Teach as this paired device. Default: one of this machine's own: local for the page, terminal with "
            "--terminal, auto with --auto.",
        ),
    ] = None
    robot: RobotAddress = None
    port: RobotPort = None
    page_port: Annotated[
        int | None,
        typer.Option(
            metavar="PORT",
            min=0,
            max=65535,
            help="TCP port of the page; 0: any. Default: as the settings say, or one of the next nine if another page "
            "has that.",
        ),
    ] = None
    page_address: PageAddressName = None
    public_address: Annotated[
        str | None, typer.Option(help="Address of a TLS proxy in front of the page, such as https://robot.example.")
    ] = None
    task: Annotated[str | None, task_option("Taught by the scripted teacher. Default: the task of the settings.")] = (
        None
    )
    teacher: Teacher = DEFAULT_TEACHER
    robot_settings: RobotName = None
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Seed of the scripted teacher.")] = 1
    settings: SettingsName = "default"
    for_run: Annotated[
        bool, typer.Option("--for-run", hidden=True, help="Started by kurt2rt run: report the pages to it as JSON.")
    ] = False

    def check(self) -> None:
        """Raise typer.BadParameter if options contradict each other."""
        refuse_if(self.terminal and self.auto, "one teacher at a time: --terminal or --auto", "--auto")
        others = (self.terminal, self.auto, self.device, self.robot, self.public_address)
        refuse_if(
            self.phone and any(each not in (False, None) for each in others),
            "it serves the pages of all devices, on the robot's machine; leave out --terminal, --auto, --device, "
            "--robot and --public-address",
            "--phone",
        )


@takes_options(_Options)
def teach(options: _Options) -> None:
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
    help shows the rest. The page waits for a robot that is not there yet.
    With --auto, a simulated robot is taught for as long as the task says.

    Ends on Ctrl-C. A robot that was driven by hand from the page is stopped;
    after --terminal and --auto it is stopped in any case.
    """
    options.check()
    service = load_service(options.settings)
    if options.phone:
        _serve(options, service, None)
        return
    name = options.device or (TERMINAL if options.terminal else AUTO if options.auto else LOCAL)
    noted = open_device(service.pairings, name, service.port)
    device = replace(noted, host=options.robot or noted.host, port=options.port or noted.port)
    if options.terminal:
        from kurt2rt.teacher.terminal.terminal import TerminalTeacher

        place = f"{device.host}:{device.port}"
        _teach(device, lambda robot, say: TerminalTeacher(robot, sys.stdin, say, place).teach())
    elif options.auto:
        _teach(device, partial(_by_script, device, service, options))
    else:
        _serve(options, service, device)


def _serve(options: _Options, service: ServiceSettings, device: Device | None) -> None:
    """Serve the page of one device, or without a device those of all."""
    # Imported here: the packages of the page are an extra, which the robot's own machine may lack.
    from kurt2rt.cli.teach_page import SPARE_PORTS, PageOptions, serve_page, serve_pages

    page_port = options.page_port
    page = PageOptions(
        port=service.page_port if page_port is None else page_port,
        spare_ports=SPARE_PORTS if page_port is None else 0,
        address=options.page_address or service.page_address,
        as_json=options.for_run,
    )
    if device is None:
        serve_pages(service, options.port or service.port, page)
    else:
        serve_page(device, page, options.public_address)


_Print = Callable[[str], None]


def _teach(device: Device, teacher: Callable[[TeacherClient, _Print], Awaitable[None]]) -> None:
    print_line = partial(print_lines, Console())

    async def run() -> None:
        async with (
            TeacherClient(device.folder, device.host, device.port) as client,
            anyio.create_task_group() as tasks,
        ):

            async def until_ended() -> None:
                reason = await until_teaching_ends(device)
                if reason:
                    print_line(reason)
                with anyio.move_on_after(1.0, shield=True):
                    await client.stop()
                tasks.cancel_scope.cancel()

            tasks.start_soon(until_ended)
            await teacher(client, print_line)
            tasks.cancel_scope.cancel()

    anyio.run(run)


async def _by_script(
    device: Device, service: ServiceSettings, options: _Options, client: TeacherClient, print_line: _Print
) -> None:
    # Here, because the page does without them, and who started kurt2rt run waits for it.
    from hal.robot_settings import load_robot, robot_that_task_names
    from kurt2rt.cli.scripted_file import people_agree
    from kurt2rt.core.task_settings import load_task, taught_by_named
    from kurt2rt.teacher.scripted.channel_teacher import teach_by_script

    try:
        await client.hello()
        # kurt2rt run has asked already whether a person's file may be used.
        lessons = () if options.for_run else await client.lessons(_NEWEST_LESSONS)
    except NoAnswerError as error:
        raise no_robot(device.host, device.port, device.name) from error
    people = dict.fromkeys(each.teacher for each in reversed(lessons) if each.teacher not in PROGRAMS)
    instead = "run the robot on another file, or let kurt2rt run --auto do so"
    if not await anyio.to_thread.run_sync(people_agree, "the robot's knowledge", tuple(people), instead):
        return
    task = taught_by_named(load_task(options.task or service.task), options.teacher)
    name = options.task or service.task
    robot = load_robot(options.robot_settings or robot_that_task_names(name) or service.robot)
    await teach_by_script(client, robot, task, print_line, seed=options.seed)
