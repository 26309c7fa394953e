"""`kurt2rt soak`."""

import shutil
import signal
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated

import anyio
import typer
from rich.console import Console
from rich.progress import Progress, TimeElapsedColumn, TimeRemainingColumn

from hal.errors import ExitCode
from hal.kurt2_settings import load_kurt2
from kurt2rt.checks.faults.table import load_faults
from kurt2rt.checks.soak.settings import SoakSettings, load_soak
from kurt2rt.cli.json_output import AsJson
from kurt2rt.cli.tables import console_of
from kurt2rt.core.task_settings import load_task
from kurt2rt.platform.malloc import pin_mmap_threshold
from kurt2rt.platform.signal_handlers import SignalHandlers
from kurt2rt.runs.recording.budget import budget_of
from kurt2rt.runs.recording.recording import Recording
from kurt2rt.service.assembly import RunSettings
from kurt2rt.service.settings import load_service

if TYPE_CHECKING:
    from kurt2rt.checks.soak.result import SoakResult

_KNOWLEDGE, _RUNS = "soak.knowledge", "runs"


_Hours = Annotated[float, typer.Option(metavar="HOURS", min=0.002, max=1000.0, help="Simulated hours.")]
_Seed = Annotated[
    int, typer.Option(metavar="N", min=0, help="Decides the robot, the noise, the faults, and the teacher's moods.")
]
_Out = Annotated[
    Path,
    typer.Option(
        file_okay=False,
        help="Folder for the report (soak.txt, soak.json, soak.png), the knowledge file and the recorded runs; "
        "those of an earlier soak go.",
    ),
]
_Day = Annotated[str, typer.Option(help="What the day is like, by name (config/soak) or a path.")]
_ByModule = Annotated[
    bool,
    typer.Option(
        "--by-module", help="Trace memory and tell which modules took more after the first hour; four times slower."
    ),
]


def soak(
    hours: _Hours = 24.0,
    seed: _Seed = 1,
    out: _Out = Path("var/soak"),
    day: _Day = "day",
    by_module: _ByModule = False,
    as_json: AsJson = False,
) -> None:
    """Let a day of the robot pass in simulated time in which everything fails.

    The robot's program runs as it does on a robot, with knowledge file,
    statistics and recorder; only its clock is simulated. It is restarted
    every half an hour or so, on another bus each time. Every minute or so
    something fails, as in kurt2rt faults. The teacher is patient, nervous, late,
    mistaken or away for an hour.

    On every tick an observer looks at the envelope of motion, at whether the
    robot stands until it is told to drive, and at whether each tick is accounted
    for. At the end memory must not have grown by more than 5 MB since the end of
    the first hour.

    24 hours take 30 to 60 minutes. Ctrl-C ends it sooner, with a report of what
    was seen until then; a second one ends it at once. Ends with code 1 when
    something did not hold.

    For example:

        kurt2rt soak --hours 0.1
        kurt2rt soak --hours 24 --out var/soak
    """
    # Late imports: simulator and plots are extras that a robot does not need.
    from kurt2rt.checks.soak.report import as_json as soak_as_json
    from kurt2rt.checks.soak.report import print_report

    settings = load_soak(day)
    result = _run_day(settings, out, hours, seed, by_module=by_module)
    if as_json:
        typer.echo(soak_as_json(result))
    else:
        print_report(result, console_of())
    _write_report(result, settings, out)
    if not result.passed:
        raise typer.Exit(ExitCode.FAILED)


def _run_day(settings: SoakSettings, out: Path, hours: float, seed: int, *, by_module: bool) -> "SoakResult":
    from kurt2rt.checks.soak.soak_run import SoakRun
    from simbridge.faults.long_run_rig import LongRunRig

    _make_room(out)
    pin_mmap_threshold()  # as the robot's program does
    table, task = load_faults(settings.faults), load_task(settings.task)
    robot = load_kurt2(table.robot)
    service = load_service().model_copy(
        update={"knowledge": str(out / _KNOWLEDGE), "checkpoint_period_s": settings.checkpoint_period_s}
    )
    recording = Recording(out / _RUNS, budget_of(settings.recordings_mb), "sim")
    rig = LongRunRig(robot, settings.world, seed)
    try:
        run_settings = RunSettings(robot, task, service)
        running = SoakRun(rig, settings, table, run_settings, recording, seed=seed, by_module=by_module)
        columns = (*Progress.get_default_columns()[:-1], TimeElapsedColumn(), TimeRemainingColumn())
        with Progress(*columns, console=Console(stderr=True)) as progress:
            bar = progress.add_task("soak", total=hours * 3600.0)
            with _first_ctrl_c(running.end):
                return anyio.run(running.run, hours, lambda now_s: progress.update(bar, completed=now_s))
    finally:
        rig.close()


def _write_report(result: "SoakResult", settings: SoakSettings, out: Path) -> None:
    from kurt2rt.checks.soak.picture import draw_soak
    from kurt2rt.checks.soak.report import as_json, print_report

    with (out / "soak.txt").open("w", encoding="utf-8") as file:
        print_report(result, Console(file=file, width=120))
    (out / "soak.json").write_text(as_json(result) + "\n", encoding="utf-8")
    draw_soak(result, settings.limits, out / "soak.png")


def _first_ctrl_c(end: Callable[[], None]) -> SignalHandlers:
    """Return handlers in which the first Ctrl-C calls `end` and restores the previous handler."""

    def on_signal(_number: int, _frame: FrameType | None) -> None:
        handlers.restore()
        end()

    handlers = SignalHandlers({signal.SIGINT: on_signal})
    return handlers


def _make_room(out: Path) -> None:
    """Create the folder, and delete the files of an earlier soak. Raises OSError."""
    out.mkdir(parents=True, exist_ok=True)
    for path in out.glob(f"{_KNOWLEDGE}*"):
        path.unlink()
    if (out / _RUNS).is_dir():
        shutil.rmtree(out / _RUNS)
