"""`kurt2rt teach`."""

import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Annotated, NamedTuple

import anyio
import anyio.to_thread
import typer
from rich.console import Console

from hal.robot_settings import load_robot
from kurt2rt.channel.security.pairing import LOCAL, OF_THIS_MACHINE, TERMINAL, Device, local_pairing, read_device
from kurt2rt.cli.no_robot import no_robot
from kurt2rt.cli.options import task_option
from kurt2rt.cli.scripted_file import people_agree
from kurt2rt.cli.teach_shutdown import end_of_teaching
from kurt2rt.core.rla.programs import AUTO, PROGRAMS
from kurt2rt.core.task_settings import load_task
from kurt2rt.service.settings import ServiceSettings, load_service
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.scripted.channel_teacher import teach_by_script
from kurt2rt.teacher.terminal.terminal import TerminalTeacher

_NEWEST_LESSONS = 20


class _Way(NamedTuple):
    """How to reach the robot, and as whom."""

    device: Device
    host: str
    port: int


def teach(
    terminal: Annotated[bool, typer.Option("--terminal", help="Teach by typing, here; no page is served.")] = False,
    auto: Annotated[
        bool, typer.Option("--auto", help="Let the scripted teacher teach, a simulated robot only; no page is served.")
    ] = False,
    phone: Annotated[
        bool,
        typer.Option("--phone", help="Serve every device: this machine and, once one is paired, the network."),
    ] = False,
    name: Annotated[
        str | None,
        typer.Option(
            "--as",
            help="Paired device that this teaches as. Default: this machine's own, which is local for the page, "
            "terminal with --terminal and auto with --auto.",
        ),
    ] = None,
    robot: Annotated[
        str | None, typer.Option(help="Address of the robot. Default: as noted when the device was paired.")
    ] = None,
    port: Annotated[
        int | None,
        typer.Option(
            metavar="PORT", min=1, max=65535, help="UDP port of the robot. Default: as noted with the pairing."
        ),
    ] = None,
    page_port: Annotated[
        int | None,
        typer.Option(
            metavar="PORT",
            min=0,
            max=65535,
            help="TCP port of the page; 0: any. Default: as the settings say, or one of the next nine where another "
            "page has that.",
        ),
    ] = None,
    host_name: Annotated[
        list[str] | None, typer.Option(help="Another name of this machine that browsers may use; can be repeated.")
    ] = None,
    public_address: Annotated[
        str | None,
        typer.Option(help="Where a TLS proxy in front of the page serves it, such as https://robot.example."),
    ] = None,
    task: Annotated[
        str | None, task_option("Taught by the scripted teacher. Default: the task of the settings.")
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Decides the scripted teacher's chance.")] = 1,
    settings: Annotated[
        str, typer.Option(help="Runtime settings by name (config/runtime) or a path to a YAML file.")
    ] = "default",
    while_stdin: Annotated[
        bool,
        typer.Option("--while-stdin", hidden=True, help="End when the standard input ends, as kurt2rt run needs it."),
    ] = False,
    pages_as_json: Annotated[bool, typer.Option("--pages-as-json", hidden=True)] = False,
) -> None:
    """Teach a robot that runs: from a browser, from a terminal, or by a script.

    Serves the teacher's page: see the robot, teach it and drive it. Start the
    robot in another terminal, then open the address that this prints:

        kurt2rt run
        kurt2rt teach

    For a phone, pair it once and scan the code that this shows; the page is open
    to the phone's network while a device is paired:

        kurt2rt pair phone
        kurt2rt teach --phone

    kurt2rt run --phone does both. On another machine than the robot, for the one
    device whose folder is there:

        kurt2rt teach --as phone --robot 192.168.0.7

    Without a browser, type: an action answers or corrects, Enter alone stops the
    robot, help shows the rest.

        kurt2rt teach --terminal

    For page and terminal the robot needs not be there yet, and may come and go.
    The scripted teacher needs a simulated robot that is there, and teaches it for
    as long as the task says.

        kurt2rt teach --auto

    Ends on Ctrl-C. A robot that was driven by hand from the page stands then; one
    that was taught by typing or by the script stands in any case.
    """
    if terminal and auto:
        raise typer.BadParameter("one teacher at a time: --terminal or --auto", param_hint="--auto")
    if phone and (terminal or auto or name is not None or robot is not None or public_address is not None):
        raise typer.BadParameter(
            "it serves the pages of all devices, beside the robot's program; leave out --terminal, --auto, --as, "
            "--robot and --public-address",
            param_hint="--phone",
        )
    service = load_service(settings)
    if phone:
        from kurt2rt.cli.teach_page import FURTHER_PORTS, serve_pages

        serve_pages(
            service,
            port or service.port,
            service.page_port if page_port is None else page_port,
            tuple(host_name or ()),
            further=FURTHER_PORTS if page_port is None else 0,
            while_stdin=while_stdin,
            as_json=pages_as_json,
        )
        return
    device = _device(service, name or (TERMINAL if terminal else AUTO if auto else LOCAL))
    way = _Way(device, robot or device.host, port or device.port)
    if terminal:
        _teach(way, lambda client, say: _by_typing(client, say, f"{way.host}:{way.port}"), while_stdin=False)
    elif auto:
        _teach(
            way,
            lambda client, say: _by_script(client, say, way, service.robot, task or service.task, seed, while_stdin),
            while_stdin=while_stdin,
        )
    else:
        # Here, because the robot's own machine may do without the packages that a page needs: they are an extra.
        from kurt2rt.cli.teach_page import FURTHER_PORTS, serve_page

        further = FURTHER_PORTS if page_port is None else 0
        at = service.page_port if page_port is None else page_port
        names = tuple(host_name or ())
        serve_page(
            device,
            way.host,
            way.port,
            at,
            names,
            further=further,
            while_stdin=while_stdin,
            public_address=public_address,
            as_json=pages_as_json,
        )


def _device(service: ServiceSettings, name: str) -> Device:
    if name in OF_THIS_MACHINE:
        return local_pairing(Path(service.teachers), Path(service.devices), name, port=service.port).device
    return read_device(Path(service.devices) / name)


_Teach = Callable[[TeacherClient, Callable[[str], None]], Awaitable[None]]


def _teach(way: _Way, teach_it: _Teach, *, while_stdin: bool) -> None:
    console = Console()

    def say(text: str) -> None:
        console.print(text, markup=False, highlight=False, soft_wrap=True)

    async def run() -> None:
        async with TeacherClient(way.device.folder, way.host, way.port) as client, anyio.create_task_group() as tasks:

            async def until_told() -> None:
                because = await end_of_teaching(way.device, while_stdin=while_stdin)
                if because:
                    say(because)
                with anyio.move_on_after(1.0, shield=True):
                    await client.stop()
                tasks.cancel_scope.cancel()

            tasks.start_soon(until_told)
            await teach_it(client, say)
            tasks.cancel_scope.cancel()

    anyio.run(run)


async def _by_typing(client: TeacherClient, say: Callable[[str], None], where: str) -> None:
    await TerminalTeacher(client, sys.stdin, say, where).teach()


async def _by_script(
    client: TeacherClient, say: Callable[[str], None], way: _Way, robot: str, task: str, seed: int, agreed: bool
) -> None:
    """`agreed`: kurt2rt run started this, and has looked whose file it is."""
    try:
        await client.hello()
        lessons = () if agreed else await client.lessons(_NEWEST_LESSONS)
    except NoAnswerError as error:
        raise no_robot(way.host, way.port, way.device.name) from error
    people = dict.fromkeys(each.teacher for each in reversed(lessons) if each.teacher not in PROGRAMS)
    instead = "run the robot on another file, or let kurt2rt run --auto do so"
    if not await anyio.to_thread.run_sync(people_agree, "the robot's knowledge", tuple(people), instead):
        return
    await teach_by_script(client, load_robot(robot), load_task(task), say, seed=seed)
