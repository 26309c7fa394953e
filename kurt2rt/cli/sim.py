"""`kurt2rt sim`."""

import math
import signal
import sys
import time
from contextlib import ExitStack
from types import FrameType
from typing import Annotated

import typer
from rich.console import Console

from hal.bus import open_bus
from hal.robot_settings import load_robot
from hal.settings import SettingsError
from kurt2rt.cli.options import RobotName, world_option
from kurt2rt.platform.signal_handlers import SignalHandlers
from kurt2rt.platform.switch_interval import short_switch_interval
from kurt2rt.service.console_thread import ConsoleThread

_ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_LOOK_S = 0.05
_STATUS_S = 1.0


def sim(
    bus: Annotated[
        str,
        typer.Option(
            help="Where the robot is: shared:NAME, a bus between programs of this machine that needs no CAN; or a "
            "SocketCAN interface such as vcan0."
        ),
    ] = "shared:kurt2",
    world: Annotated[str, world_option("Default: a.")] = "a",
    start: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, help="Start pose of the world, 1, 2, ...; default: the seed decides."),
    ] = None,
    seed: Annotated[
        int, typer.Option(metavar="N", min=0, help="Decides the robot's sensors, its noise and where it starts.")
    ] = 1,
    robot: RobotName = "kurt2",
    seconds: Annotated[
        float | None, typer.Option(metavar="SECONDS", min=0.1, help="Switch off after so long; default: on Ctrl-C.")
    ] = None,
    while_stdin: Annotated[
        bool, typer.Option("--while-stdin", help="Switch off when the standard input ends, for use in scripts.")
    ] = False,
) -> None:
    """Simulate a KURT2 on a CAN bus, in real time: controllers, sensors and wheels in a world.

    For all that talks to it this is the robot: it obeys CONTROL, sends telemetry
    100 times a second, and brakes by itself when CONTROL ceases for 0.2 s. What
    can be tried with it needs no robot, and no CAN in the kernel:

        kurt2rt sim --bus shared:desk
        kurt2rt run --robot shared:desk --page

    With the kernel's CAN, its tools work as well (candump vcan0):

        sudo modprobe vcan
        sudo ip link add vcan0 type vcan
        sudo ip link set vcan0 up
        kurt2rt sim --bus vcan0

    A line once a second tells where it is, how its wheels turn, what they were
    told, and how often. Type `help` for what a hand could do: put the robot
    elsewhere, lift it, move a wall. Its identity frames (INFO_1, INFO_2) say that
    it is simulated. A bus that goes down does not switch it off: it stands, and
    goes on when the bus is back. Ctrl-C, or SIGTERM, switches it off.
    """
    if seconds is not None and not math.isfinite(seconds):
        raise typer.BadParameter("a number of seconds has an end", param_hint="--seconds")
    if bus.startswith("virtual:"):
        raise typer.BadParameter(
            "nobody outside this program hears a virtual bus; give shared:NAME", param_hint="--bus"
        )
    # Here, because a robot carries no simulator: the packages it needs are an extra.
    from simbridge.sim_console import News, SimConsole, StatusLine, TypedLines
    from simbridge.simulated_world import Kurt2World
    from simbridge.standalone import StandaloneRobot
    from simbridge.worlds.world_loading import load_world

    settings = load_robot(robot)
    ground_plan = load_world(world, settings)
    if start is not None and start > len(ground_plan.start_poses):
        raise SettingsError(
            f"has {len(ground_plan.start_poses)} start poses, there is none of number {start}", where=f"world {world}"
        )
    console = Console()

    def tell(text: str) -> None:
        console.print(text, markup=False, highlight=False, soft_wrap=True)

    with ExitStack() as ending:
        end = _Wish()
        # Started in the background it would be halted where it looks what was typed, but for SIGTTIN.
        ending.enter_context(SignalHandlers({**dict.fromkeys(_ENDING, end.note), signal.SIGTTIN: signal.SIG_IGN}))
        printer = ending.enter_context(ConsoleThread())

        def say(text: str) -> None:
            printer.submit(lambda: tell(text))

        standalone = StandaloneRobot(settings, ground_plan, open_bus(bus), seed, start=start)
        say(f"a simulated {settings.name} in world {world} is on bus {bus}; type help, Ctrl-C switches it off")
        ending.enter_context(short_switch_interval())
        ending.enter_context(standalone)
        simulation = standalone.simulation
        desk = SimConsole(
            standalone, ground_plan, Kurt2World(standalone.robot, ground_plan, settings.geometry, simulation)
        )
        keyboard, news, line = TypedLines(sys.stdin), News(standalone), StatusLine(standalone)
        ends_at_s = math.inf if seconds is None else time.monotonic() + seconds
        status_at_s = time.monotonic() + _STATUS_S
        while not end.came:
            time.sleep(_LOOK_S)
            for typed in keyboard.typed():
                say(desk.obey(typed))
            for each in news.since():
                say(each)
            now_s = time.monotonic()
            if now_s >= status_at_s:
                status_at_s += _STATUS_S
                say(line.next())
            if now_s >= ends_at_s or simulation.error is not None or (while_stdin and keyboard.ended):
                break
    robot_now = standalone.robot
    tell(
        f"switched off after {robot_now.time_s:.2f} s: {robot_now.collisions} collisions, "
        f"{simulation.missed_cycles} cycles missed, state {robot_now.state_hash()[:16]}"
    )


class _Wish:
    """Whether somebody wants the program to end: signals only note it, and it ends where it looks."""

    def __init__(self) -> None:
        self.came = False

    def note(self, _number: int, _frame: FrameType | None) -> None:
        self.came = True
