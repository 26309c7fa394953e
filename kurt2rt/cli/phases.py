"""`kurt2rt study phases`."""

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
    seeds_option,
    task_option,
)
from kurt2rt.cli.study_run import EngineOptions, job_parts, study_run
from kurt2rt.cli.tables import print_study
from kurt2rt.cli.typed_command import typed_command
from kurt2rt.core.task_settings import load_task, taught_by_named

_SEEDS, _QUICK_SEEDS = "100-119", "0-1"
_FOLDER = Path("results/phases")


@dataclass(frozen=True, slots=True, kw_only=True)
class _Options(EngineOptions):
    task: Annotated[str, task_option("It needs a section `phases`. Default: wall_following.")] = "wall_following"
    teacher: Teacher = DEFAULT_TEACHER
    changes: Changes = None
    robot_settings: RobotName = None
    quick: Annotated[
        bool, typer.Option("--quick", help="All steps with two robots in under a minute, each for seconds only.")
    ] = False
    seeds: Annotated[str | None, seeds_option(_SEEDS, _QUICK_SEEDS)] = None
    out: Annotated[Path | None, results_option(f"{_FOLDER}/ and the task's name, with -quick behind it")] = None


@takes_options(_Options)
def phases(options: _Options) -> None:
    """Train robots through phases 1 to 5, next to controls.

    In phase 1 the teacher answers, in 2 corrects, in 3 rewards, and in 4 teaches
    a critic. In phase 5 the robot goes on alone. An exam follows each phase, and
    a long run the last. The controls begin with the knowledge of phase 2, some
    of its actions made wrong. They show how much each phase repairs.

    Writes report.html, the figures as PNG, and each
    robot's results and knowledge files after each step in the output folder.

    An interrupted run goes on where it was. If settings or the program changed
    since, the command refuses the folder: give a new one. Settings were searched
    on seeds 0 to 79. With one of those, or with fewer than 20 robots, nothing is
    judged.

    For example:

        kurt2rt study phases --quick
        kurt2rt study phases --task wall_following --seeds 100-119
    """
    # Late imports: the simulator is an extra that `kurt2rt run` on the robot does not need.
    from kurt2rt.experiments.phases.figures import draw_figures
    from kurt2rt.experiments.phases.study import make_plan
    from kurt2rt.experiments.phases.tables import all_tables, read_study, reasons_not_to_judge, write_phases

    seeds = options.seeds or (_QUICK_SEEDS if options.quick else _SEEDS)
    robot = load_robot_of(options.robot_settings, options.task)
    task = taught_by_named(load_task(options.task, changes=changes_of(options.changes)), options.teacher)
    folder = options.out or _FOLDER / (task.name + ("-quick" if options.quick else ""))
    parts = job_parts(robot, folder)
    plan = make_plan(task, parse_seeds(seeds), parts, quick=options.quick, engine=options.requested_engine())
    command = typed_command("study phases", options, {"task": options.task, "seeds": seeds})
    with study_run(plan, parts, options) as bar:
        bar.say("figures and report")
        study, report = read_study(plan), folder / "report.html"
        write_phases(study, list(draw_figures(study, folder)), command, report)
    reasons = list(reasons_not_to_judge(plan))
    print_study(all_tables(study, reasons), reasons, as_json=options.as_json, report=report)
