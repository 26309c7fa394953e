"""`kurt2rt run`."""

import math
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated, Literal

import anyio
import typer
from rich.console import Console

from hal.health import Health
from hal.robot_settings import load_robot
from kurt2rt.app import NO_WIRE, SIMULATED, OpenedRobot, open_robot
from kurt2rt.channel.channel import Channel
from kurt2rt.channel.credentials import OF_THIS_MACHINE, local_pairing
from kurt2rt.cli.companions import Companions
from kurt2rt.cli.options import WireName
from kurt2rt.cli.printer import Printer
from kurt2rt.health.instruments import Instruments
from kurt2rt.knowledge.writer import Acknowledgement
from kurt2rt.layers.wanted import Wanted
from kurt2rt.recording.can_log import open_can_log
from kurt2rt.rla.rla import MID, rla_title
from kurt2rt.rounds import Screen, Status
from kurt2rt.service import Openness, serve
from kurt2rt.service_settings import ServiceSettings, load_service
from kurt2rt.tasks.settings import load_task
from kurt2rt.teaching.scripted_lesson import several_behaviours
from kurt2rt.timing.priority import take_real_time_priority


def run(
    robot: Annotated[
        str,
        typer.Option(
            help="sim: a simulated robot in this program; else the bus that the robot is on, a SocketCAN interface "
            "such as can0, or shared:NAME, where kurt2rt sim is one."
        ),
    ] = "sim",
    settings: Annotated[
        str, typer.Option(help="Runtime settings by name (config/runtime) or a path to a YAML file.")
    ] = "default",
    task: Annotated[
        str | None,
        typer.Option(
            help="Task by name (config/tasks) or a path to its YAML file; with a knowledge file of its own beside that "
            "of the settings, and in its own world, unless these are given. Default: as the settings say."
        ),
    ] = None,
    knowledge: Annotated[
        Path | None, typer.Option(help="Knowledge file; made when absent. Default: as the settings say.")
    ] = None,
    world: Annotated[
        str | None, typer.Option(help="World of the simulated robot. Default: as the settings say.")
    ] = None,
    teacher: Annotated[
        Literal["channel", "none"],
        typer.Option(help="channel: teachers come over UDP; none: nobody, the robot drives where it knows the way."),
    ] = "channel",
    behaviour: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Taught behaviour that is wanted at the start, where the task has several; a teacher may say another "
            "one later. Default: the task's first.",
        ),
    ] = None,
    page: Annotated[
        bool, typer.Option("--page", help="Start the teacher's page as well and print its address.")
    ] = False,
    auto: Annotated[
        bool,
        typer.Option(
            "--auto", help="Let the scripted teacher of the task teach, over the channel; simulated robot only."
        ),
    ] = False,
    port: Annotated[
        int | None,
        typer.Option(min=0, max=65535, help="UDP port of the channel; 0: any. Default: as the settings say."),
    ] = None,
    page_port: Annotated[
        int | None,
        typer.Option(min=0, max=65535, help="TCP port of the page; 0: any. Default: as the settings say."),
    ] = None,
    can_log: Annotated[
        Path | None,
        typer.Option(
            help="Keep every frame that is heard and sent, with its time, in a new file: .log (candump's), .asc, .blf, "
            ".csv, .trc or .mf4. 140 MB an hour as .log.",
        ),
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(min=0.1, help="End after so long; default: run until Ctrl-C.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Decides the simulated robot's start and noise.")] = 1,
    wire: WireName = NO_WIRE,
) -> None:
    """Run the robot in real time, 100 ticks a second, until Ctrl-C or SIGTERM.

    The robot drives where it was taught to and stands where it was not: then
    it asks. Each lesson is in the knowledge file before it is acknowledged. A
    status line tells once a second what drives the wheels, which rule says so,
    and how punctual the loop is.

    Teach it from a browser or from another terminal:

        kurt2rt run --page
        kurt2rt teach --terminal

    Without a paired device (kurt2rt pair) only this machine is listened to. In
    phases 1 to 4 the robot drives only while its teacher is there.

    With --robot can0 set the interface up first; the robot then stands until
    its teacher says resume, whatever it knows:

        sudo ip link set can0 up type can bitrate 1000000

    A robot of which the rest does not know that it is simulated runs in a program
    of its own; it stands until resume as well:

        kurt2rt sim --bus shared:desk
        kurt2rt run --robot shared:desk --page

    With --teacher none nobody can say resume: any robot drives at once where
    it knows the situation, and once stopped by the guard it stands until the
    program is started anew. Of several taught behaviours it follows one:

        kurt2rt run --teacher none --task streets --behaviour turn_left
    """
    if seconds is not None and not math.isfinite(seconds):
        raise typer.BadParameter("a number of seconds has an end", param_hint="--seconds")
    if auto and robot != SIMULATED:
        raise typer.BadParameter("a scripted teacher teaches the simulated robot only", param_hint="--auto")
    if wire != NO_WIRE and robot != SIMULATED:
        raise typer.BadParameter("only the simulated robot in this program has a simulated wire", param_hint="--wire")
    if (page or auto) and teacher == "none":
        raise typer.BadParameter("a page and a scripted teacher come over the channel", param_hint="--teacher")
    service = _changed(load_service(settings), task, knowledge, world, port)
    robot_settings, taught = load_robot(service.robot), load_task(service.task)
    if auto and len(taught.behaviours) > 1:
        raise typer.BadParameter(several_behaviours(taught), param_hint="--auto")
    if behaviour is not None:
        try:
            Wanted(taught.behaviours).pursue(behaviour)
        except ValueError as error:
            raise typer.BadParameter(str(error), param_hint="--behaviour") from error
    console = Console()

    def tell(text: str, style: str | None = None) -> None:
        console.print(text, style=style, markup=False, highlight=False, soft_wrap=True)

    tell(f"task {taught.name}, robot {robot}, knowledge {service.knowledge}; Ctrl-C ends")
    if service.real_time_priority:
        tell(take_real_time_priority(service.real_time_priority))
    with ExitStack() as ending:
        companions = ending.enter_context(Companions(settings))
        printer = ending.enter_context(Printer())

        def say(text: str, style: str | None = None) -> None:
            printer.put(lambda: tell(text, style))

        def settled(acknowledgement: Acknowledgement) -> None:
            if acknowledgement.error is not None:
                say(f"not saved: {acknowledgement.command_id}: {acknowledgement.error}", "red")

        log = None if can_log is None else ending.enter_context(open_can_log(can_log, robot))
        opened = ending.enter_context(open_robot(robot_settings, robot, service.world, seed, log, wire))

        drops, says = {"lines for the terminal": lambda: printer.dropped}, {}
        if log is not None:
            drops["frames for the CAN log"], says["CAN log"] = lambda: log.lost, lambda: log.trouble
        instruments = Instruments(lambda: opened.robot.health, drops, says)

        def line(status: Status) -> str:
            trouble = "" if log is None else log.trouble
            return " | ".join(part for part in (status_line(status, opened.robot.health), trouble) if part)

        def show(status: Status) -> None:
            # The line is made by the printer as well: the percentiles in it cost more than a tick.
            printer.put(lambda: tell(line(status)))

        at = () if page_port is None else ("--page-port", str(page_port))

        def listening(channel: Channel) -> None:
            say(f"teachers are listened to on UDP port {channel.endpoint.port}", "cyan")
            if page:
                companions.start("teach", "--port", str(channel.endpoint.port), *at)
            if auto:
                companions.start("teach", "--auto", "--port", str(channel.endpoint.port), "--task", service.task)

        openness = None if teacher == "none" else _open(service, opened, listening)

        async def serve_it() -> Status | None:
            return await serve(
                opened.robot,
                robot_settings,
                service,
                taught,
                Screen(status=show, question=lambda question: say(str(question), "yellow"), settled=settled),
                openness=openness,
                duration_s=seconds,
                stopped=robot != SIMULATED and teacher == "channel",
                behaviour=behaviour,
                instruments=instruments,
            )

        last = anyio.run(serve_it)
    count = "" if last is None else f"; {len(last.runtime.level.system)} RLAs are in {service.knowledge}"
    if log is not None:
        tell(log.trouble or f"{log.written} frames are in {log.name}")
    tell(f"the robot stands{count}")


def _changed(
    service: ServiceSettings, task: str | None, knowledge: Path | None, world: str | None, port: int | None
) -> ServiceSettings:
    if task is not None:
        taught = load_task(task)
        beside = str(Path(service.knowledge).with_name(f"{taught.name}.knowledge"))
        service = service.model_copy(update={"task": task, "world": taught.teaching.world, "knowledge": beside})
    given = {"knowledge": None if knowledge is None else str(knowledge), "world": world, "port": port}
    return service.model_copy(update={key: value for key, value in given.items() if value is not None})


def _open(service: ServiceSettings, opened: OpenedRobot, listening: Callable[[Channel], None]) -> Openness:
    """Open to teachers, those of this machine among them."""
    for name in sorted(OF_THIS_MACHINE):
        local_pairing(Path(service.teachers), Path(service.devices), name, port=service.port)

    return Openness(lambda: opened.robot.health.trouble, opened.ground, listening)


def status_line(status: Status, health: Health) -> str:
    """One line: what drives the wheels and why, lessons, punctuality, and what is wrong."""
    record, runtime = status.record, status.runtime
    decision, match = record.decision, record.decision.match
    near = "" if match is None else f" at {match.distance:.0f} of R {match.radius:.0f}"
    if decision.rla_id is not None:
        doing = f"{decision.action} by {rla_title(decision.rla_id, record.behaviour)}{near}"
    elif decision.driving:
        doing = f"{decision.action}, as the teacher says"
    elif decision.asking and decision.asks_at == MID:
        doing = "stands and asks the way" + ("" if match is None else f", nearest {match.rla.title}{near}")
    elif decision.asking:
        about = f" about {record.behaviour}" if record.behaviour else ""
        doing = "stands and asks" + (about if match is None else f", nearest {match.rla.title}{near}")
    elif runtime.school.stopped_because or record.grant.latched:
        doing = f"stands until Go: {runtime.school.stopped_because or record.grant.reasons[0]}"
    else:
        doing = f"stands: {decision.cause.value}"
    if decision.mid is not None and decision.driving:
        by = "its teacher" if decision.mid.rla_id is None else rla_title(decision.mid.rla_id, "", MID)
        doing += f", sent by {by}"
    lateness = runtime.ledger.lateness()
    parts = [
        f"{record.tick * runtime.robot.can.cycle_s:8.1f} s",
        f"{doing:<48}",
        f"{len(runtime.level.system):3d} RLAs",
        f"late {lateness.median_us / 1000:.2f} ms, p99 {lateness.p99_us / 1000:.2f} ms",
        f"missed {runtime.ledger.missed_ticks}",
    ]
    if record.grant.reasons:
        parts.append("guard: " + ", ".join(record.grant.reasons))
    if status.unsaved_lessons:
        parts.append(f"{status.unsaved_lessons} lessons not saved yet")
    if status.trouble is not None:
        parts.append(status.trouble)
    if runtime.school.learning.trouble:
        parts.append(runtime.school.learning.trouble)
    if status.channel_trouble:
        parts.append(status.channel_trouble)
    if health.trouble:
        parts.append(health.trouble)
    if health.foreign_control:
        parts.append(f"{health.foreign_control} CONTROL frames of another sender so far")
    return " | ".join(parts)
