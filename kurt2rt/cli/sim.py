"""`kurt2rt sim`."""

import math
import signal
import sys
import time
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, cast

import typer
from rich.console import Console

from config.settings import SettingsError
from hal.robot_settings import RobotSettings, load_robot_of
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.options import RobotName, refuse_if, require_finite, world_option
from kurt2rt.platform.signal_handlers import SignalHandlers
from kurt2rt.platform.switch_interval import short_switch_interval
from kurt2rt.platform.text_table import print_lines
from kurt2rt.service.console_thread import ConsoleThread
from simbridge.contracts.robot_kind import kind_of

if TYPE_CHECKING:
    from simbridge.links import RobotEnd

_END_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_POLL_S = 0.05
_STATUS_S = 1.0


@dataclass(frozen=True, slots=True)
class _Options:
    bus: Annotated[
        str,
        typer.Option(
            help="Bus of the robot: shared:NAME, which connects programs of this machine without CAN; or a SocketCAN "
            "interface such as vcan0. For another kind of robot: the address that its plug-in takes, such as "
            "/tmp/school or tcp/127.0.0.1:7447."
        ),
    ] = "shared:kurt2"
    world: Annotated[str, world_option("Default: a.")] = "a"
    start: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, help="Start pose of the world, 1, 2, ...; default: the seed decides."),
    ] = None
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Seed of the robot's sensors, noise and start.")] = 1
    robot: RobotName = None
    seconds: Annotated[
        float | None, typer.Option(metavar="SECONDS", min=0.1, help="Switch off after this time. Default: at Ctrl-C.")
    ] = None
    while_stdin: Annotated[
        bool, typer.Option("--while-stdin", help="Switch off when the standard input ends, for use in scripts.")
    ] = False


@takes_options(_Options)
def sim(options: _Options) -> None:
    """Simulate a KURT2 on a CAN bus, in real time.

    It behaves on the bus as the robot does: it obeys CONTROL, sends telemetry
    100 times a second, and brakes when CONTROL ceases for 0.2 s. This needs no
    robot, and no CAN in the kernel:

        kurt2rt sim --bus shared:desk
        kurt2rt run --bus shared:desk --page

    With the kernel's CAN, its tools work as well (candump vcan0):

        sudo modprobe vcan
        sudo ip link add vcan0 type vcan
        sudo ip link set vcan0 up
        kurt2rt sim --bus vcan0

    A line once a second shows the robot's pose, its wheel speeds, and the set
    points that it got, with their rate. Type `help` for commands that move the
    robot, lift it, or move a wall. Its identity frames (INFO_1, INFO_2) say that
    it is simulated. If the bus goes down, the robot stands, and goes on when the
    bus is back. Ctrl-C, or SIGTERM, switches it off.
    """
    require_finite(options.seconds)
    refuse_if(options.bus.startswith("virtual:"), "a virtual bus reaches no other program; give shared:NAME", "--bus")
    settings = load_robot_of(options.robot, options.world)
    _simulate(options, settings)


def _simulate(options: _Options, settings: RobotSettings) -> None:
    # Here, because a robot carries no simulator: the packages it needs are an extra.
    from simbridge.realtime import RealtimeWorld, StandaloneRobot
    from simbridge.sim_console import News, SimConsole, StatusLine, TypedLines
    from simbridge.worlds.world_loading import load_world

    ground_plan = load_world(options.world, settings)
    poses = len(ground_plan.start_poses)
    if options.start is not None and options.start > poses:
        raise SettingsError(
            f"has {poses} start poses, there is none of number {options.start}", where=f"world {options.world}"
        )
    console = Console()
    with ExitStack() as stack:
        signals: list[int] = []
        # Without SIGTTIN ignored, a process in the background would be halted as it reads the keyboard.
        stack.enter_context(
            SignalHandlers(
                {
                    **dict.fromkeys(_END_SIGNALS, lambda number, _: signals.append(number)),
                    signal.SIGTTIN: signal.SIG_IGN,
                }
            )
        )
        printer = stack.enter_context(ConsoleThread())

        def log(text: str) -> None:
            printer.submit(lambda: print_lines(console, text))

        robot_end = cast("RobotEnd", kind_of(settings).serve(settings, options.bus))
        standalone = StandaloneRobot(
            ground_plan, robot_end, options.seed, start=options.start, cycle_s=settings.cycle_s
        )
        log(
            f"a simulated {settings.name} in world {options.world} is on {robot_end.name}; "
            "type help, Ctrl-C switches it off"
        )
        stack.enter_context(short_switch_interval())
        stack.enter_context(standalone)
        simulation = standalone.simulation
        world = RealtimeWorld(standalone.robot, ground_plan, settings.geometry, simulation)
        desk, keyboard = SimConsole(standalone, ground_plan, world), TypedLines(sys.stdin)
        news, line = News(standalone), StatusLine(standalone)
        ends_at_s = math.inf if options.seconds is None else time.monotonic() + options.seconds
        status_at_s = time.monotonic() + _STATUS_S
        while not signals:
            time.sleep(_POLL_S)
            for typed in keyboard.typed():
                log(desk.obey(typed))
            for each in news.since():
                log(each)
            now_s = time.monotonic()
            if now_s >= status_at_s:
                status_at_s += _STATUS_S
                log(line.next())
            if now_s >= ends_at_s or simulation.error is not None or (options.while_stdin and keyboard.ended):
                break
    robot = standalone.robot
    console.print(
        f"switched off after {robot.time_s:.2f} s: {robot.collisions} collisions, "
        f"{simulation.missed_cycles} cycles missed, state {robot.state_hash()[:16]}",
        highlight=False,
        soft_wrap=True,
    )
