"""`kurt2rt commission`."""

import getpass
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, NamedTuple

import anyio
import anyio.abc
import typer
from rich.console import Console

from config.errors import ExitCode
from config.settings import SettingsError
from hal.bus import open_bus
from hal.codec import load_codec
from hal.kurt2 import Kurt2
from hal.kurt2_settings import Kurt2Settings, load_kurt2
from kurt2rt.checks.commission.checklist import (
    STEPS,
    Checklist,
    blocking_failures,
    open_steps,
    step_named,
    steps_to_run,
)
from kurt2rt.checks.commission.console_operator import ConsoleOperator
from kurt2rt.checks.commission.listener import Listener
from kurt2rt.checks.commission.operator import AbortedError
from kurt2rt.checks.commission.progress import Findings, Progress, StepOutcome, load_progress
from kurt2rt.checks.commission.report import as_text, print_report
from kurt2rt.checks.commission.robot_file import write_robot_file
from kurt2rt.checks.commission.step import CommissionStep
from kurt2rt.checks.commission.test_stand import TestStand
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.options import RobotName, refuse_if
from kurt2rt.platform.durable_files import write_durably
from kurt2rt.platform.text_table import print_lines
from kurt2rt.platform.timerfd_clock import TimerfdClock
from kurt2rt.service.shutdown import SHUTDOWN_SIGNALS

_NAMES = ", ".join(step.name for step in STEPS)


@dataclass(frozen=True, slots=True)
class _Options:
    bus: Annotated[
        str,
        typer.Argument(help="The robot's bus: a SocketCAN interface such as can0, or shared:NAME.", show_default=False),
    ]
    name: Annotated[str, typer.Option(help="What this robot is called: up to 40 of a-z, 0-9 and -.")] = "my-kurt2"
    robot_settings: RobotName = None
    only: Annotated[
        str | None,
        typer.Option(help=f"Run only these steps, even if they passed: some of {_NAMES}.", show_default=False),
    ] = None
    skip: Annotated[
        str | None,
        typer.Option(
            help="Skip these steps, even if they failed, so that the file can be written without them.",
            show_default=False,
        ),
    ] = None


@takes_options(_Options)
def commission(options: _Options) -> None:
    """Commission a real robot: the checklist of its first day.

    It listens for the controller's identity and every frame. It tries the speed
    modes, each wheel's side and direction, the emergency stop and the
    controller's own watchdog. You hold a hand in front of each sensor and press
    each bumper, so it finds their channels. With a ruler it fits the infra-red
    law. At the end it writes the robot's settings file.

    You need an hour, a block that lifts all wheels, a ruler and a flat board.
    Keep a hand near the switch that cuts the motors. No wheel turns until you
    type that the wheels are up. Then each turn waits for Enter, is slow, and
    passes the guard. Ctrl-C and Ctrl-Z brake at any time.

    Set the interface up first:

        sudo ip link set can0 up type can bitrate 1000000
        kurt2rt commission can0 --name my-kurt2

    Results are kept after each step, so the same command goes on with the steps
    that have not passed. A step that fails prints what to mend. The file is
    written when every step has passed or was skipped, but not while identity,
    modes, wheels or stop fail. Then name it as robot: in the runtime settings
    (a copy of config/runtime/default.yaml):

        kurt2rt run --bus can0 --settings my-runtime.yaml

    Rehearse it without a robot; type `lift` in the first program to put it on a
    block:

        kurt2rt sim --bus shared:desk
        kurt2rt commission shared:desk --name practice --skip sensors,bumpers,infrared

    Ends with code 1 if a step of this session failed.
    """
    console = Console()
    target = _target(options.name)
    session = _session(options)
    print_lines(console, f"{options.name} on {options.bus}; progress is kept in {session.path}; Ctrl-C brakes")
    _tell_earlier(console, session.progress, session.chosen)
    taken = anyio.run(_run_checklist, session, console)
    print_report(taken, STEPS, console)
    report = session.path.with_suffix(".txt")
    write_durably(report, as_text(taken, STEPS))
    print_lines(console, f"all that was measured: {report}")
    _conclude(console, taken, session.base, target)
    records = [taken.steps[step.name] for step in session.chosen if step.name in taken.steps]
    if any(record.outcome is StepOutcome.FAILED for record in records):
        raise typer.Exit(ExitCode.FAILED)


def _session(options: _Options) -> "_Session":
    """Return what the options ask for. Raises typer.BadParameter, SettingsError."""
    requested, skipped = _named(options.only, "--only"), _named(options.skip, "--skip")
    base = load_kurt2(options.robot_settings or "kurt2")
    path = Path("var", "commission", f"{options.name}.json")
    fresh = Progress(name=options.name, base=options.robot_settings or "kurt2", bus=options.bus)
    progress = _progress(path, fresh)
    chosen = [step for step in (requested or steps_to_run(progress)) if step not in skipped]
    return _Session(base, progress, path, chosen, skipped)


def _target(name: str) -> Path:
    """Return the settings file to write. Raises typer.BadParameter."""
    refuse_if(not re.fullmatch(r"[a-z0-9][a-z0-9-]{0,39}", name), "up to 40 of a-z, 0-9 and -", "--name")
    target = Path("var", "robots", f"{name}.yaml")
    refuse_if(target.exists(), f"{target} is there already; give another name, or move it", "--name")
    return target


def _tell_earlier(console: Console, progress: Progress, chosen: Sequence[CommissionStep]) -> None:
    for step in STEPS:
        record = progress.steps.get(step.name)
        if step not in chosen and record is not None and step.name != "lifted":
            text = f"  {step.name}: {record.outcome} on {record.at}, {record.who}; again with --only {step.name}"
            print_lines(console, text)


class _Session(NamedTuple):
    """Steps of one session, and the progress that they continue."""

    base: Kurt2Settings
    progress: Progress
    path: Path
    """Progress file."""
    chosen: Sequence[CommissionStep]
    skipped: Sequence[CommissionStep]


async def _run_checklist(session: _Session, console: Console) -> Progress:
    base, bus = session.base, session.progress.bus
    listener = Listener(open_bus(bus), load_codec(base.can.database))
    with TimerfdClock() as clock:
        stand = TestStand(
            base,
            lambda settings: Kurt2(settings, open_bus(bus)),
            listener,
            clock,
            ConsoleOperator(sys.stdin, console),
            second_guard=True,
        )
        checklist = Checklist(stand, session.progress, session.path, _user(), _now)
        stopped = True
        async with anyio.create_task_group() as tasks:
            await tasks.start(_cancel_on_signal, tasks.cancel_scope)
            with stand:  # inside of the scope: after any end the wheels are braked first
                try:
                    await checklist.run(session.chosen, session.skipped)
                except AbortedError:
                    print_lines(console, "left; the same command goes on from here")
                stopped = False  # not by a signal
            tasks.cancel_scope.cancel()
        if stopped:
            print_lines(console, "stopped: the wheels are braked; the same command goes on from here")
        return checklist.progress


async def _cancel_on_signal(scope: anyio.CancelScope, *, task_status: anyio.abc.TaskStatus[None]) -> None:
    with anyio.open_signal_receiver(*SHUTDOWN_SIGNALS) as signals:
        task_status.started()
        async for _ in signals:
            scope.cancel()


def _conclude(console: Console, progress: Progress, base: Kurt2Settings, target: Path) -> None:
    """Write the settings file, or print why it cannot be written."""
    blocking = blocking_failures(progress)
    missing = open_steps(progress)
    if blocking:
        failed = ", ".join(step.name for step in blocking)
        print_lines(
            console, f"no settings file is written while these fail: {failed}; mend, then run the same command again"
        )
        return
    if missing:
        waiting = ", ".join(step.name for step in missing)
        print_lines(
            console, f"no settings file yet; steps not taken: {waiting}; go on with the same command, or --skip them"
        )
        return
    try:
        write_robot_file(target, base, progress, STEPS)
    except SettingsError as error:
        print_lines(console, f"no settings file yet: {error}")
        return
    use = f"use it: robot: {target} in a copy of config/runtime/default.yaml, then"
    print_lines(console, f"written: {target}", use)
    print_lines(console, f"        kurt2rt run --bus {progress.bus} --settings THAT.yaml", whole=True)


def _progress(path: Path, fresh: Progress) -> Progress:
    try:
        kept = load_progress(path)
    except FileNotFoundError:
        return fresh
    if kept.base != fresh.base:
        raise SettingsError(
            f"was begun with --robot-settings {kept.base}",
            where=path,
            do="go on with that, give another --name, or remove this file",
        )
    if kept.bus != fresh.bus and kept.findings != Findings() and kept.findings.hardware_id is None:
        raise SettingsError(
            f"was begun on bus {kept.bus}, and which robot that was is not known",
            where=path,
            do="go on there, give another --name, or remove this file",
        )
    return kept.model_copy(update={"bus": fresh.bus})


def _named(names: str | None, option: str) -> list[CommissionStep]:
    words = [] if names is None else [word.strip() for word in names.split(",") if word.strip()]
    try:
        return [step_named(word) for word in words]
    except KeyError as error:
        raise typer.BadParameter(f"no step {error.args[0]}; there are: {_NAMES}", param_hint=option) from error


def _now() -> str:
    return datetime.now(UTC).strftime("%Y-%m-%d %H:%M")


def _user() -> str:
    try:
        return " ".join(getpass.getuser().split())
    except (KeyError, OSError):  # a user without a name, as in a container
        return "unknown"
