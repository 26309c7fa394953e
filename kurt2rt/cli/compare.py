"""`kurt2rt study compare`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hal.robot_settings import load_robot_of
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
from kurt2rt.core.task_robot import require_robot_of
from kurt2rt.core.task_settings import load_task, taught_by_named

_AFTER = (10, 20, 40)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Options(EngineOptions):
    learner: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME[=GATE]",
            help="Learner: a name, or module:Name of your own, also from this folder. GATE is the threshold from which "
            "it asks. Repeat for several. Default: 1-nn, k-nn, weighted-vote, svm, tree.",
            show_default=False,
        ),
    ] = None
    task: Annotated[list[str] | None, task_option("Repeat for several. Default: wall_following.")] = None
    teacher: Teacher = DEFAULT_TEACHER
    seeds: Annotated[str, typer.Option(help="Robots by their seeds, e.g. 4106-4125.")] = "4106-4125"
    checkpoint: Annotated[
        list[int] | None,
        typer.Option(
            min=1,
            help="Examine the robot after this number of presses, and at the end of its lesson; repeat for several. "
            f"Default: {', '.join(map(str, _AFTER))}.",
            show_default=False,
        ),
    ] = None
    changes: Changes = None
    out: Annotated[Path, results_option("results/compare")] = Path("results/compare")
    robot_settings: RobotName = None


@takes_options(_Options)
def compare(options: _Options) -> None:
    """Compare learners of other kinds with the RLA system, taught by the same teacher.

    The same robots are taught with each learner, through the same teacher, guard
    and sensors. They are examined without the teacher after 10, 20 and 40
    presses and at the end. The tables show the robots that pass, the teacher's
    effort, and collisions during the lesson. Each row is compared with the RLA
    system, robot by robot.

    For example, all learners of the project; one with another gate in two
    tasks; your own:

        kurt2rt study compare
        kurt2rt study compare --learner k-nn=0.8 --task fleeing --task eight
        kurt2rt study compare --learner mine:Mine

    Results are kept in --out, so an interrupted run goes on where it was.
    docs/extend.md says how to write a learner.
    """
    # Not at the top: the simulator and drawing are extras, and every command is loaded where --help is said.
    from kurt2rt.experiments.compare.pupil import PUPILS, Pupil
    from kurt2rt.experiments.compare.study import make_plan
    from kurt2rt.experiments.compare.tables import all_tables, draw_curves, read_comparison
    from kurt2rt.experiments.study.targets import reasons_against_judging

    names = dict.fromkeys(options.task or ("wall_following",))
    robot = load_robot_of(options.robot_settings, next(iter(names)))
    tasks = [taught_by_named(load_task(name, changes=changes_of(options.changes)), options.teacher) for name in names]
    for name, task in zip(names, tasks, strict=True):
        require_robot_of(task, name, robot)
    parts = job_parts(robot, options.out)
    plan = make_plan(
        tasks,
        [Pupil.parse(name) for name in options.learner or PUPILS],
        parse_seeds(options.seeds),
        sorted(set(options.checkpoint or _AFTER)),
        parts,
        engine=options.requested_engine(),
    )
    figure = options.out / "compare.png"
    with study_run(plan, parts, options) as bar:
        bar.say("figure")
        comparison = read_comparison(plan)
        draw_curves(comparison, figure)
    print_study(all_tables(comparison), reasons_against_judging(plan.seeds), as_json=options.as_json, figure=figure)
