"""`kurt2rt study doubt`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.options import RobotName, parse_seeds, results_option, task_option
from kurt2rt.cli.study_run import JobOptions, job_parts, study_run
from kurt2rt.cli.tables import print_study
from kurt2rt.core.task_robot import load_task_and_robot
from kurt2rt.experiments.doubt.drive import DoubtResponse


@dataclass(frozen=True, slots=True, kw_only=True)
class _Options(JobOptions):
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
    out: Annotated[Path, results_option("results/doubt")] = Path("results/doubt")
    robot_settings: RobotName = None


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

    Results are kept in --out, so an interrupted run goes on where it was.
    """
    # Not at the top: the simulator is an extra, and every command is loaded where --help is said.
    from kurt2rt.experiments.doubt.study import DoubtDrives, all_tables, make_plan

    task, robot = load_task_and_robot(options.task, options.robot_settings)
    parts = job_parts(robot, options.out)
    about = DoubtDrives(
        task,
        tuple(options.world or task.exam.worlds),
        tuple(options.response or DoubtResponse),
        options.seconds,
        options.reposition_after,
    )
    plan = make_plan(about, parse_seeds(options.seeds), options.taught, parts)
    with study_run(plan, parts, options):
        tables = list(all_tables(plan))
    print_study(tables, (), as_json=options.as_json)
