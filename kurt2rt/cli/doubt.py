"""`kurt2rt study doubt`."""

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
from kurt2rt.experiments.doubt.drive import DoubtResponse, DoubtSetup, with_doubt
from kurt2rt.experiments.doubt.jobs import DoubtJob, collision_table, score_table
from kurt2rt.experiments.study.jobs import world_of
from kurt2rt.experiments.study.pool import run_jobs
from kurt2rt.experiments.study.table import as_rich
from kurt2rt.platform.text_table import print_whole


@dataclass(frozen=True, slots=True)
class _Options:
    taught: Annotated[Path, typer.Argument(help="Folder with knowledge files, as kurt2rt train --seeds leaves them.")]
    task: Annotated[str, task_option("Default: wall_following.")] = "wall_following"
    seeds: Annotated[str, typer.Option(help="Robots by their seeds, e.g. 0-4.")] = "0-4"
    world: Annotated[
        list[str] | None,
        typer.Option(help="World to drive in; repeat for several. Default: those of the exam."),
    ] = None
    seconds: Annotated[float, typer.Option(metavar="SECONDS", min=1.0, help="Seconds of each drive.")] = 200.0
    response: Annotated[
        list[DoubtResponse] | None,
        typer.Option(help="Response of the robots to doubt; repeat for several. Default: all."),
    ] = None
    reposition_after: Annotated[
        float,
        typer.Option(
            metavar="SECONDS",
            min=0.0,
            help="Move a robot that stands for this time to another start; 0: never.",
        ),
    ] = 10.0
    jobs: Jobs = ALL_PROCESSORS
    robot_settings: RobotName = None
    as_json: AsJson = False


@takes_options(_Options)
def doubt(options: _Options) -> None:
    """Measure how well doubt predicts wrong actions and collisions; the control is distance alone.

    Each robot drives without a teacher in each world twice: it only reports
    doubt, and doubt stops it. SEED in the name of a world stands for the robot's
    seed.

    For example:

        kurt2rt train --task wall_following --seeds 915-919
        kurt2rt study doubt results/train --seeds 915-919 --world floors-SEED
        kurt2rt study doubt results/train --seeds 915-919 --world floors-SEED --response stands --reposition-after 0
    """
    # Not at the top: the simulator is an extra, and `kurt2rt run` on the robot does without it.
    import scipy.special  # noqa: F401 # of the extra `studies`: told before the drives, not after them

    taught, settings = load_task_and_robot(options.task, options.robot_settings)
    task = with_doubt(taught, DoubtResponse.TELLS)
    factory = simulations_of(settings)
    worlds = options.world or list(task.exam.worlds)
    seeds = parse_seeds(options.seeds)
    factory.require_worlds(*(world_of(world, seed) for world in worlds for seed in seeds))
    responses = tuple(options.response or DoubtResponse)
    work = [
        DoubtJob(
            factory,
            settings,
            task,
            options.taught / f"{task.name}-{seed}.knowledge",
            DoubtSetup(world_of(world, seed), seed, options.seconds, response, options.reposition_after),
        )
        for response in responses
        for seed in seeds
        for world in worlds
    ]
    columns = (TextColumn("drives"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress:
        bar = progress.add_task("drives", total=len(work))
        logs = run_jobs(work, options.jobs, on_done=lambda _place: progress.advance(bar))
    each = len(work) // len(responses)
    by_response = {response.value: logs[n * each : (n + 1) * each] for n, response in enumerate(responses)}
    assert task.learning.doubt is not None
    tables = [collision_table(by_response, options.reposition_after)]
    told = by_response.get(DoubtResponse.TELLS.value)
    if told is not None:
        tables.insert(0, score_table(told, task.learning.doubt.threshold))
    if options.as_json:
        print_json({"tables": tables_of(tables)})
        return
    for table in tables:
        print_whole(console_of(), as_rich(table))
