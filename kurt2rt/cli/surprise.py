"""`kurt2rt surprise`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from hal.robot_kind import simulations_of
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.options import ALL_PROCESSORS, Jobs, RobotName, parse_seeds, task_option
from kurt2rt.cli.tables import console_of, tables_of
from kurt2rt.core.task_robot import load_task_and_robot
from kurt2rt.experiments.study.pool import run_jobs
from kurt2rt.experiments.study.table import as_rich
from kurt2rt.experiments.surprise.jobs import DIFFERENT_S, LEARNS_S, SurpriseJob, surprise_table
from kurt2rt.platform.text_table import print_whole


@dataclass(frozen=True, slots=True)
class _Options:
    """Arguments and options of `kurt2rt surprise`."""

    taught: Annotated[
        Path, typer.Argument(help="Folder with knowledge files, as kurt2rt lesson --task streets --seeds leaves them.")
    ]
    task: Annotated[str, task_option("Default: streets.")] = "streets"
    seeds: Annotated[str, typer.Option(help="Robots by their seeds, e.g. 0-9.")] = "0-9"
    learns_s: Annotated[
        float,
        typer.Option("--learns", metavar="SECONDS", min=1.0, help="Seconds that a robot gets to know what to expect."),
    ] = LEARNS_S
    different_s: Annotated[
        float,
        typer.Option("--different", metavar="SECONDS", min=1.0, help="Seconds that it drives with each difference."),
    ] = DIFFERENT_S
    jobs: Jobs = ALL_PROCESSORS
    robot_settings: RobotName = None
    as_json: AsJson = False


@takes_options(_Options)
def surprise(options: _Options) -> None:
    """Measure how surprised taught robots are: on known ground, and after something changed.

    The folder holds one knowledge file per robot; each learns to expect what
    follows, then something in its world is made different.

    For example:

        kurt2rt lesson --task streets --seeds 0-9
        kurt2rt surprise results/lesson
    """
    what, settings = load_task_and_robot(options.task, options.robot_settings)
    stage = simulations_of(settings)
    work = [
        SurpriseJob(
            stage,
            settings,
            what,
            options.taught / f"{what.name}-{seed}.knowledge",
            seed,
            options.learns_s,
            options.different_s,
        )
        for seed in parse_seeds(options.seeds)
    ]
    columns = (TextColumn("robots"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress:
        bar = progress.add_task("robots", total=len(work))
        results = run_jobs(work, options.jobs, on_done=lambda _place: progress.advance(bar))
    if options.as_json:
        print_json({"tables": tables_of([surprise_table(results)])})
    else:
        print_whole(console_of(), as_rich(surprise_table(results)))
