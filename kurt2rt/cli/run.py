"""`kurt2rt run`. The robot's packages are imported by the command, not by its help."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.interrupt import end_at_interrupt
from kurt2rt.cli.options import (
    DEFAULT_TEACHER,
    PageAddressName,
    RobotName,
    SettingsName,
    refuse_if,
    require_finite,
    task_option,
    world_option,
)
from kurt2rt.platform.extras import extra_for
from kurt2rt.service.bus_names import SIMULATED

if TYPE_CHECKING:
    from hal.robot_settings import RobotSettings
    from kurt2rt.core.task_settings import TaskSettings
    from kurt2rt.service.program import RobotProgram
    from kurt2rt.service.run_options import RunOptions
    from kurt2rt.service.settings import ServiceSettings

_CHANNEL, _NO_TEACHER = "channel", "none"
_OF_ONE = ("bus", "behaviour", "teacher", "auto", "knowledge", "port", "page_port", "can_log", "record", "live_view")
"""Options of one robot, which --robots refuses."""
_NOT_RECORDED = (
    "the run is not recorded without foxglove-sdk; pip install '.[recording]' in kurt2rt's folder, or give --no-record"
)


@dataclass(frozen=True, slots=True)
class _Options:
    bus: Annotated[
        str,
        typer.Option(
            help="Bus of the robot: a SocketCAN interface such as can0, or shared:NAME for a robot of kurt2rt sim. For "
            "another kind of robot: the address that its plug-in takes, such as /dev/ttyACM0. sim: a simulated robot "
            "in this program."
        ),
    ] = SIMULATED
    robots: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            min=2,
            max=8,
            help="Run N simulated robots for a class, each with a page, a code to scan and knowledge of its own, in "
            "var/class.",
        ),
    ] = None
    robot_settings: RobotName = None
    settings: SettingsName = "default"
    task: Annotated[
        str | None,
        task_option(
            "It has its own world and knowledge file, unless they are given. Default: the task of the knowledge file, "
            "else that of the settings."
        ),
    ] = None
    knowledge: Annotated[
        Path | None, typer.Option(help="Knowledge file; made when absent. Default: as the settings say.")
    ] = None
    world: Annotated[
        str | None, world_option("Of the simulated robot. Default: the world of the task or of the settings.")
    ] = None
    teacher: Annotated[
        str,
        typer.Option(
            metavar="channel|none|NAME",
            help="channel: teachers connect over UDP. none: the robot drives without a teacher wherever it knows what "
            "to do. With --auto the scripted teacher: a name in config/teachers, or the path of a YAML file. Default: "
            f"{DEFAULT_TEACHER}.",
        ),
    ] = _CHANNEL
    behaviour: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Taught behaviour to start with, if the task has several. A teacher can choose another one later; "
            "with --auto the others follow in turn. Default: the task's first.",
        ),
    ] = None
    page: Annotated[bool, typer.Option("--page", help="Start the teacher's page, too, and print its address.")] = False
    phone: Annotated[
        bool,
        typer.Option(
            "--phone",
            help="Start the page for paired devices as well (kurt2rt pair phone). While a device is paired, the page "
            "is open to the network and the code to scan stays on screen.",
        ),
    ] = False
    no_open: Annotated[bool, typer.Option("--no-open", help="Do not open the page in this desktop's browser.")] = False
    auto: Annotated[
        bool,
        typer.Option(
            "--auto",
            help="Let a scripted teacher teach, over the channel; simulated robot only. Without --knowledge its "
            "lessons go to TASK.auto.knowledge, never to a person's file.",
        ),
    ] = False
    port: Annotated[
        int | None,
        typer.Option(
            metavar="PORT", min=0, max=65535, help="UDP port of the channel; 0: any. Default: as the settings say."
        ),
    ] = None
    page_port: Annotated[
        int | None,
        typer.Option(
            metavar="PORT", min=0, max=65535, help="TCP port of the page; 0: any. Default: as the settings say."
        ),
    ] = None
    page_address: PageAddressName = None
    can_log: Annotated[
        Path | None,
        typer.Option(
            help="Write each CAN frame that is received or sent, with its time, to a new file: .log (candump's), "
            ".asc, .blf, .csv or .trc. 140 MB an hour as .log.",
        ),
    ] = None
    record: Annotated[
        Path | None,
        typer.Option(
            help="Folder for the recording of this run: what the robot senses, decides and learns. kurt2rt replay and "
            "Foxglove read it; about 70 MB an hour. Default: as the settings say."
        ),
    ] = None
    no_record: Annotated[bool, typer.Option("--no-record", help="Record nothing of this run.")] = False
    live_view: Annotated[
        str | None,
        typer.Option(
            metavar="[HOST:]PORT",
            help="Show the same live to Foxglove, over a WebSocket on this port; 0: any. Without HOST only this "
            "machine can connect; there is no password.",
        ),
    ] = None
    service: Annotated[
        bool,
        typer.Option(
            "--service",
            help="Run as a systemd unit does (kurt2rt service): wait for bus, disk and network, and stand until Go.",
        ),
    ] = False
    seconds: Annotated[
        float | None, typer.Option(metavar="SECONDS", min=0.1, help="End after this time. Default: run until Ctrl-C.")
    ] = None
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Seed of the simulated robot's start and noise.")] = 1


@takes_options(_Options)
def run(options: _Options) -> None:
    """Run the robot in real time, until Ctrl-C or SIGTERM.

    100 times a second the robot decides by the nearest rule that it was taught.
    If this rule is farther than R from the situation, the robot stands and asks.
    Each lesson is in the knowledge file before it is acknowledged. A status line
    shows once a second what drives the wheels, by which rule, and how punctual
    the loop is.

    Teach it from a browser or from another terminal:

        kurt2rt run --page
        kurt2rt teach --terminal

    To teach from a phone as well, pair it, before or while this runs:

        kurt2rt run --phone
        kurt2rt pair phone

    Without a paired device (kurt2rt pair) only this machine can teach. In
    phases 1 to 4 the robot drives only while its teacher is there.

    With --bus can0 set the interface up first. The robot then stands until its
    teacher says resume, whatever it knows:

        sudo ip link set can0 up type can bitrate 1000000

    To test against a simulated robot in a separate program, as if it were real
    (it stands until resume, too):

        kurt2rt sim --bus shared:desk
        kurt2rt run --bus shared:desk --page

    The run is recorded: kurt2rt replay decides it again, kurt2rt why explains
    it, and Foxglove shows it.

    With --teacher none no teacher can say resume. So the robot drives at once
    if it knows the situation. If the guard stops it, it stands until you start
    the program again. If the task has several behaviours, choose one:

        kurt2rt run --teacher none --task streets --behaviour turn_left
    """
    _require_consistent(options)
    if options.robots is not None:
        _run_robots(options, options.robots)
        return
    with end_at_interrupt():
        import kurt2rt.service.program
        import kurt2rt.teacher.scripted.channel_teacher  # noqa: F401  # loads all that the program needs

        recorded = _load_recorder(options)
    _program(options, recorded=recorded).run()


def _load_recorder(options: _Options) -> bool:
    """Import the recorder unless it is not wanted; return whether the run is recorded.

    Without the extra `recording` a run is not recorded. Raises ModuleNotFoundError then if --record is given.
    """
    if options.no_record:
        return False
    try:
        import kurt2rt.runs.recording.recorder  # noqa: F401
    except ModuleNotFoundError as error:
        if options.record is not None or extra_for(error) != "recording":
            raise
        return False
    return True


def _require_consistent(options: _Options) -> None:
    """Raise typer.BadParameter for options that exclude each other."""
    simulated = options.bus == SIMULATED
    require_finite(options.seconds)
    refuse_if(options.auto and not simulated, "a scripted teacher teaches the simulated robot only", "--auto")
    refuse_if(
        (options.page or options.phone or options.auto) and options.teacher == _NO_TEACHER,
        "a page and a scripted teacher come over the channel",
        "--teacher",
    )
    refuse_if(
        not options.auto and options.teacher not in (_CHANNEL, _NO_TEACHER),
        f"{options.teacher!r} is neither {_CHANNEL} nor {_NO_TEACHER}; a scripted teacher by name needs --auto",
        "--teacher",
    )
    refuse_if(
        options.no_record and options.record is not None,
        "either a folder to record to, or nothing is recorded",
        "--no-record",
    )
    refuse_if(
        options.service and (options.auto or options.robots is not None or options.teacher == _NO_TEACHER),
        "after each start it waits for a person who says Go",
        "--service",
    )


def _run_robots(options: _Options, count: int) -> None:
    """Run several robots. Raises typer.BadParameter for an option that robots cannot share, such as --port."""
    given = ", ".join(
        f"--{name.replace('_', '-')}" for name in _OF_ONE if getattr(options, name) != getattr(_Options(), name)
    )
    refuse_if(bool(given), "each robot of --robots is simulated, for people, with ports and files of its own", given)
    with end_at_interrupt():
        from rich.console import Console

        from kurt2rt.cli.robots import class_robots, run_robots
    robots = class_robots(count, _checked(options, options.task)[0])
    words = ("--seed", str(options.seed), *(["--no-record"] if options.no_record else []))
    run_robots(robots, words, Console(), browser=not options.no_open, seconds=options.seconds)


def _program(options: _Options, *, recorded: bool) -> "RobotProgram":
    from rich.console import Console

    from kurt2rt.cli.scripted_file import require_agreement
    from kurt2rt.cli.terminal_screen import TerminalScreen
    from kurt2rt.service.program import RobotProgram
    from kurt2rt.service.settings import load_service
    from kurt2rt.teacher.scripted.channel_teacher import mid_level_refusal

    live_view = _live_view(options.live_view)
    task = options.task
    # A service may wait for a disk that is not there yet.
    if options.knowledge is not None and not options.service and options.knowledge.exists():
        task = _task_of(options.knowledge, task, load_service(options.settings).task)
    if options.auto and options.knowledge is not None:
        require_agreement(options.knowledge)
    settings, taught, robot = _checked(options, task)
    refuse_if(options.auto and taught.mid is not None, mid_level_refusal(taught), "--auto")
    run_options = _run_options(options, live_view, recorded=recorded)
    screen = TerminalScreen(
        Console(),
        settings.pairings.devices,
        as_service=options.service,
        phones=options.phone,
        browser=not options.no_open,
    )
    if run_options.unrecorded:
        screen.print_line(run_options.unrecorded, "yellow")
    return RobotProgram(run_options, settings, robot, taught, screen)


def _checked(options: _Options, task: str | None) -> "tuple[ServiceSettings, TaskSettings, RobotSettings]":
    """Return the settings with the command line applied to them, task and robot, as they fit each other.

    Raises SettingsError, or typer.BadParameter for an unknown behaviour.
    """
    from hal.robot_settings import load_robot
    from kurt2rt.core.task_robot import require_robot_of
    from kurt2rt.core.task_settings import load_task
    from simbridge.contracts.robot_kind import simulations_of

    settings = _changed(options, task)
    taught, robot = load_task(settings.task), load_robot(settings.robot)
    require_robot_of(taught, settings.task, robot)
    _require_behaviour(taught, options.behaviour)
    if options.world is not None and options.bus == SIMULATED:
        simulations_of(robot).require_worlds(options.world)  # before the line that says what runs
    return settings, taught, robot


def _run_options(options: _Options, live_view: tuple[str, int] | None, *, recorded: bool) -> "RunOptions":
    from kurt2rt.service.run_options import RunOptions

    simulated, attended = options.bus == SIMULATED, options.teacher != _NO_TEACHER
    return RunOptions(
        bus=options.bus,
        settings=options.settings,
        as_service=options.service,
        attended=attended,
        stopped=options.service or (attended and not simulated),
        behaviour=options.behaviour or "",
        page=options.page or options.phone,
        phones=options.phone,
        scripted_teacher=_scripted_teacher(options),
        page_port=options.page_port,
        can_log=options.can_log,
        record=recorded,
        unrecorded="" if recorded or options.no_record else _NOT_RECORDED,
        live_view=live_view,
        seconds=options.seconds,
        seed=options.seed,
    )


def _scripted_teacher(options: _Options) -> str | None:
    """Return the name or path of the scripted teacher; None without --auto. Raises SettingsError."""
    from kurt2rt.core.teacher_settings import load_teacher

    if not options.auto:
        return None
    name = DEFAULT_TEACHER if options.teacher == _CHANNEL else options.teacher
    load_teacher(name)
    return name


def _live_view(address: str | None) -> tuple[str, int] | None:
    if address is None:
        return None
    # Late import: foxglove-sdk is in the extra `recording`.
    from kurt2rt.runs.recording.live_view import parse_address

    try:
        return parse_address(address)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="--live-view") from error


def _require_behaviour(task: "TaskSettings", behaviour: str | None) -> None:
    from kurt2rt.core.decision.decision import ActiveBehaviour
    from kurt2rt.core.outcome import CommandRefusedError
    from kurt2rt.core.outcome_text import text_of

    if behaviour is not None:
        try:
            ActiveBehaviour(task.behaviours).select(behaviour)
        except CommandRefusedError as error:
            raise typer.BadParameter(text_of(error.outcome), param_hint="--behaviour") from error


def _task_of(knowledge: Path, given: str | None, usual: str) -> str | None:
    """Return --task: as given, or the task of the knowledge file where it is another than the `usual` one."""
    from kurt2rt.core.task_settings import load_task
    from kurt2rt.knowledge.files.task_of_file import system_of_file, task_of_file

    if given is None and system_of_file(knowledge) == load_task(usual).system_name:
        return None
    return task_of_file(knowledge, given)


def _changed(options: _Options, task: str | None) -> "ServiceSettings":
    """Read the runtime settings and apply the command line to them. Raises SettingsError."""
    from config.robot_plugins import find_task_of_robot
    from hal.robot_settings import robot_that_task_names
    from kurt2rt.cli.scripted_file import own_file
    from kurt2rt.core.task_settings import load_task
    from kurt2rt.service.settings import load_service

    settings = load_service(options.settings)
    named = options.robot_settings or (None if task is None else robot_that_task_names(task))
    if named is not None:
        settings = settings.model_copy(update={"robot": named})
        task = task or find_task_of_robot(named)
    if task is not None:
        taught = load_task(task)
        knowledge = str(Path(settings.knowledge).with_name(f"{taught.name}.knowledge"))
        settings = settings.model_copy(update={"task": task, "world": taught.teaching.world, "knowledge": knowledge})
    if options.auto and options.knowledge is None:
        settings = settings.model_copy(update={"knowledge": str(own_file(Path(settings.knowledge)))})
    files = {"knowledge": options.knowledge, "recordings": options.record}
    given: dict[str, object] = {key: None if path is None else str(path) for key, path in files.items()}
    given |= {"world": options.world, "port": options.port, "page_address": options.page_address}
    return settings.model_copy(update={key: value for key, value in given.items() if value is not None})
