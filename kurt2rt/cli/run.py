"""`kurt2rt run`."""

import math
import sys
import uuid
from pathlib import Path
from typing import Annotated, Literal

import anyio
import typer
from rich.console import Console

from behaviors.repertoire import load_repertoire
from hal.health import Health
from hal.robot_settings import RobotSettings, load_robot
from kurt2rt.app import SIMULATED, open_robot
from kurt2rt.cli.printer import Printer
from kurt2rt.cli.terminal import TerminalTeacher
from kurt2rt.knowledge.writer import Acknowledgement
from kurt2rt.rla.rla import Phase
from kurt2rt.service import Screen, Status, Watcher, serve
from kurt2rt.service_settings import load_service
from kurt2rt.tasks.settings import TaskSettings, load_task
from kurt2rt.teaching.commands import Command
from kurt2rt.teaching.scripted_teacher import picture_of, teacher_of
from kurt2rt.tick import TickRecord
from kurt2rt.timing.priority import take_real_time_priority


def run(
    robot: Annotated[
        str, typer.Option(help="sim: the simulated robot; else the SocketCAN interface of a real one, such as can0.")
    ] = "sim",
    settings: Annotated[
        str, typer.Option(help="Runtime settings by name (config/runtime) or a path to a YAML file.")
    ] = "default",
    knowledge: Annotated[
        Path | None, typer.Option(help="Knowledge file; made when absent. Default: as the settings say.")
    ] = None,
    world: Annotated[
        str | None, typer.Option(help="World of the simulated robot. Default: as the settings say.")
    ] = None,
    teacher: Annotated[
        Literal["none", "terminal", "scripted"],
        typer.Option(
            help="terminal: type actions and commands here; scripted: the task's reference policy answers and "
            "corrects, for the simulated robot only; none: nobody."
        ),
    ] = "terminal",
    seconds: Annotated[
        float | None, typer.Option(min=0.1, help="End after so long; default: run until Ctrl-C.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Decides the simulated robot's start and noise.")] = 1,
) -> None:
    """Run the robot in real time, 100 ticks a second, until Ctrl-C or SIGTERM.

    The robot drives where it was taught to and stands where it was not: then
    it asks. Each lesson is in the knowledge file before it is acknowledged. A
    status line tells once a second what drives the wheels, which rule says so,
    and how punctual the loop is. Type an action to answer the robot's question,
    or to correct it while it drives; "help" lists what else can be typed.

    With --robot can0 set the interface up first; the robot then stands until
    you type resume, whatever it knows:

        sudo ip link set can0 up type can bitrate 1000000

    With --teacher none nobody can say resume: a real robot drives at once where
    it knows the situation, and once stopped by the guard it stands until the
    program is started anew.
    """
    if seconds is not None and not math.isfinite(seconds):
        raise typer.BadParameter("a number of seconds has an end", param_hint="--seconds")
    service = load_service(settings)
    changes: dict[str, str] = {}
    if knowledge is not None:
        changes["knowledge"] = str(knowledge)
    if world is not None:
        changes["world"] = world
    service = service.model_copy(update=changes)
    robot_settings, task = load_robot(service.robot), load_task(service.task)
    if teacher == "scripted" and robot != "sim":
        raise typer.BadParameter("a scripted teacher teaches the simulated robot only", param_hint="--teacher")
    console = Console()
    console.print(
        f"task {task.name}, robot {robot}, knowledge {service.knowledge}; Ctrl-C ends",
        markup=False,
        highlight=False,
        soft_wrap=True,
    )
    if service.real_time_priority:
        console.print(take_real_time_priority(service.real_time_priority), highlight=False)
    printer = Printer()

    def say(text: str, style: str | None = None) -> None:
        printer.put(lambda: console.print(text, style=style, markup=False, highlight=False, soft_wrap=True))

    def settled(acknowledgement: Acknowledgement) -> None:
        if acknowledgement.error is not None:
            say(f"not saved: {acknowledgement.command_id}: {acknowledgement.error}", "red")
        elif teacher == "terminal":
            say("saved", "cyan")

    watch: Watcher | None = None
    if teacher == "scripted":
        watch = scripted_watch(task, robot_settings, seed)
    elif teacher == "terminal":
        actions = tuple(load_repertoire(task.repertoire, robot_settings))
        person = TerminalTeacher(
            sys.stdin,
            actions,
            lambda text: say(text, "cyan"),
            session=new_session("terminal"),
        )
        console.print(person.help, style="cyan", highlight=False)
        person.start()
        watch = person.watch
    with printer, open_robot(robot_settings, robot, service.world, seed) as opened:

        def show(status: Status) -> None:
            # The line is made by the printer as well: the percentiles in it cost more than a tick.
            printer.put(
                lambda: console.print(status_line(status, opened.health), markup=False, highlight=False, soft_wrap=True)
            )

        screen = Screen(status=show, question=lambda question: say(str(question), "yellow"), settled=settled)

        async def serve_it() -> Status | None:
            return await serve(
                opened,
                robot_settings,
                service,
                task,
                screen,
                teacher=watch,
                duration_s=seconds,
                stopped=robot != SIMULATED and teacher == "terminal",
            )

        last = anyio.run(serve_it)
    count = "" if last is None else f"; {len(last.runtime.level.system)} RLAs are in {service.knowledge}"
    console.print(f"the robot stands{count}", markup=False, highlight=False, soft_wrap=True)


def scripted_watch(task: TaskSettings, robot: RobotSettings, seed: int) -> Watcher:
    """The scripted teacher for a run in real time: answers, and corrects after the task's time of phase 1."""
    actions = tuple(load_repertoire(task.repertoire, robot))
    teacher = teacher_of(task, robot, actions, seed=seed, session=new_session("scripted"))
    corrections_from = round(task.teaching.supervised_s / robot.can.cycle_s)

    def watch(record: TickRecord) -> Command | None:
        if teacher.phase is Phase.SUPERVISED and record.tick >= corrections_from:
            return teacher.enter(Phase.CORRECTIONS)
        return teacher.watch(picture_of(record))

    return watch


def status_line(status: Status, health: Health) -> str:
    """One line: what drives the wheels and why, lessons, punctuality, and what is wrong."""
    record, runtime = status.record, status.runtime
    decision, match = record.decision, record.decision.match
    near = "" if match is None else f" at {match.distance:.0f} of R {match.radius:.0f}"
    if decision.driving:
        doing = f"{decision.action} by RLA {decision.rla_id}{near}"
    elif decision.asking:
        doing = "stands and asks" + ("" if match is None else f", nearest RLA {match.rla.rla_id}{near}")
    else:
        doing = f"stands: {decision.cause.value}"
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
    if health.latched is not None and health.bus_trouble:
        parts.append(health.bus_trouble)
    if health.foreign_control:
        parts.append(f"{health.foreign_control} CONTROL frames from somebody else on the bus: find and end it")
    return " | ".join(parts)


def new_session(teacher: str) -> str:
    """A name that no earlier session has, for the ids of this session's commands."""
    return f"{teacher}-{uuid.uuid4().hex[:12]}"
