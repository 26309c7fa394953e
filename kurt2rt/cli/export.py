"""`kurt2rt export ...`: recorded runs for other programs."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.progress import job_bars
from kurt2rt.cli.recorded_run import RunsFolder, RuntimeSettingsName
from kurt2rt.runs.recording.run_folder import find_run
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.run import Run
from kurt2rt.service.settings import load_service

if TYPE_CHECKING:
    from kurt2rt.runs.export.lerobot import OnEntry
    from kurt2rt.runs.recording.entries import TickEntry

export = typer.Typer(help="Write recorded runs as data sets for other programs.", no_args_is_help=True)

_REPORT_EVERY_TICKS = 500


@export.callback()
def _group() -> None:
    """Keep `lerobot` a word of its own: typer runs the only command of a group without its name."""


@export.command()
def lerobot(
    run: Annotated[
        list[Path] | None,
        typer.Argument(
            help="Recorded runs: their folders, files in them, or their names in --runs. Default: the newest."
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of the data set; nothing may be there yet.")] = Path(
        "results/lerobot"
    ),
    fps: Annotated[
        int, typer.Option(metavar="N", help="Frames a second, a divisor of the robot's ticks a second.")
    ] = 100,
    runs: RunsFolder = None,
    as_json: AsJson = False,
    settings: RuntimeSettingsName = "default",
) -> None:
    """Write recorded runs as a data set for LeRobot (LeRobotDataset v3.0), an episode for each run or 1 000 s of it.

    A frame holds wheel speeds (observation.state), sensor readings
    (observation.environment_state), the speeds that were decided (action), the
    teacher's rewards (next.reward), and whether a teacher drove by hand.
    docs/python.md explains each column.

        kurt2rt export lerobot
        kurt2rt export lerobot var/runs/*-wall_following --fps 20
    """
    # Late import: pyarrow is in the extra `export`, and this module is imported without it.
    from kurt2rt.runs.export.lerobot import export_lerobot

    folder = runs or Path(load_service(settings).recordings)
    named = [find_run(each, folder) for each in run] if run else [find_run(None, folder)]
    found = [read_run(each, partial=True) for each in dict.fromkeys(named)]
    with _bars() as on_entry:
        exported = export_lerobot(found, out, fps, on_entry)
    if as_json:
        print_json({"folder": out, "fps": fps, "runs": exported})
        return
    for each in exported:
        episodes = "1 episode" if each.episodes == 1 else f"{each.episodes} episodes"
        typer.echo(f"{each.run}: {episodes}, {each.frames} frames" + (f"; {each.trouble}" if each.trouble else ""))
    typer.echo(f"data set  {out}")


@contextmanager
def _bars() -> Iterator["OnEntry"]:
    whole_s: dict[str, float] = {}
    with job_bars() as report:

        def on_entry(run: Run, entry: "TickEntry") -> None:
            if entry.number % _REPORT_EVERY_TICKS == 0:
                done_s = run.elapsed_s(entry)
                if run.name not in whole_s:
                    whole_s[run.name] = run.duration_s
                report(Path(run.name).name, done_s, max(whole_s[run.name], done_s))

        yield on_entry
