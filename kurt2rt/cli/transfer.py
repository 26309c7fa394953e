"""`kurt2rt study transfer`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.options import (
    DEFAULT_TEACHER,
    Changes,
    RobotName,
    Teacher,
    changes_of,
    parse_seeds,
    results_option,
    task_option,
)
from kurt2rt.cli.study_run import EngineOptions, job_parts, study_run
from kurt2rt.cli.tables import print_study
from kurt2rt.core.task_robot import load_task_and_robot
from kurt2rt.core.task_settings import taught_by_named
from kurt2rt.experiments.transfer.study import AFTER, NewWorlds, make_plan

_WORLDS = {"streets": "streets-SEED"}
"""New world of a task without --world; rooms-SEED for other tasks."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Options(EngineOptions):
    task: Annotated[str, task_option("Default: wall_following.")] = "wall_following"
    teacher: Teacher = DEFAULT_TEACHER
    there: Annotated[
        str | None,
        typer.Option(
            "--teacher-there",
            metavar="NAME|PATH",
            help="Scripted teacher of the new world. Default: the teacher of home.",
            show_default=False,
        ),
    ] = None
    seeds: Annotated[str, typer.Option(help="Robots by their seeds, e.g. 1100-1119.")] = "1100-1119"
    world: Annotated[
        list[str] | None,
        typer.Option(
            help="New world, as in other commands; SEED in the name stands for the robot's seed. Repeat for several: "
            "each robot is taught in each of them separately. Default: rooms-SEED, for streets streets-SEED.",
            show_default=False,
        ),
    ] = None
    checkpoint: Annotated[
        list[int] | None,
        typer.Option(
            min=0,
            help="Examine the robot after this number of presses in the new world; repeat for several. "
            f"Default: {', '.join(map(str, AFTER))}.",
            show_default=False,
        ),
    ] = None
    seconds: Annotated[
        float | None,
        typer.Option(
            metavar="SECONDS",
            min=1.0,
            help="Longest time of teaching in the new world. Default: that of the lesson at home.",
            show_default=False,
        ),
    ] = None
    changes: Changes = None
    out: Annotated[Path, results_option("results/transfer")] = Path("results/transfer")
    robot_settings: RobotName = None


@takes_options(_Options)
def transfer(options: _Options) -> None:
    """Measure how many presses a robot that was taught at home needs to be right in a new world.

    Each robot is taught in the world of its task (home). Then the same teacher
    goes on in a new world, and answers and corrects as at home. After 0, 2, 5,
    10, 15 and 20 presses the robot is examined there without its teacher. It is
    examined at home once it is right in the new world, and at the end. The
    policy's own drive from the same start is the measure. The result is a curve:
    the share of robots that are right, by presses.

    For example, other rooms for each robot; and other streets:

        kurt2rt study transfer
        kurt2rt study transfer --task streets --teacher superhuman

    Results are kept in --out, so an interrupted run goes on where it was.
    """
    # Not at the top: the simulator and drawing are extras, and every command is loaded where --help is said.
    from kurt2rt.experiments.study.targets import reasons_against_judging
    from kurt2rt.experiments.transfer.tables import all_tables, draw_curves, read_study

    shipped, robot = load_task_and_robot(options.task, options.robot_settings, changes=changes_of(options.changes))
    parts = job_parts(robot, options.out)
    places = options.world or [_WORLDS.get(shipped.name, "rooms-SEED")]
    plan = make_plan(
        taught_by_named(shipped, options.teacher),
        NewWorlds(tuple(places), tuple(sorted(set(options.checkpoint or AFTER))), options.seconds, options.there),
        parse_seeds(options.seeds),
        parts,
        engine=options.requested_engine(),
    )
    figure = options.out / "transfer.png"
    with study_run(plan, parts, options) as bar:
        bar.say("figure")
        study = read_study(plan)
        draw_curves(study, figure)
    print_study(all_tables(study), reasons_against_judging(plan.seeds), as_json=options.as_json, figure=figure)
