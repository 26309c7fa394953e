"""`kurt2rt study paper`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hal.robot_settings import load_robot
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.options import (
    DEFAULT_TEACHER,
    Teacher,
    parse_seeds,
    results_option,
    seeds_option,
    task_option,
)
from kurt2rt.cli.study_run import EngineOptions, job_parts, study_run
from kurt2rt.cli.tables import print_study
from kurt2rt.cli.typed_command import typed_command

_SEEDS, _QUICK_SEEDS = "100-119", "100-101"
_FOLDER, _QUICK_FOLDER = Path("results/paper"), Path("results/paper-quick")


@dataclass(frozen=True, slots=True, kw_only=True)
class _Options(EngineOptions):
    quick: Annotated[
        bool, typer.Option("--quick", help="A small part in under a minute: fewer tasks and seeds, short lessons.")
    ] = False
    seeds: Annotated[str | None, seeds_option(_SEEDS, _QUICK_SEEDS)] = None
    task: Annotated[
        list[str] | None,
        task_option("Repeat for several. Default: all tasks of config/paper."),
    ] = None
    teacher: Teacher = DEFAULT_TEACHER
    out: Annotated[Path | None, results_option(f"{_FOLDER}, with --quick {_QUICK_FOLDER}")] = None
    paper_defaults: Annotated[
        bool,
        typer.Option("--paper-defaults/--no-paper-defaults", help="Also do all of it with the paper's own settings."),
    ] = True


@takes_options(_Options)
def paper(options: _Options) -> None:
    """Teach the tasks of the paper, and compare the results.

    Writes report.html, the figures as PNG, and each
    robot's result and knowledge file in the output folder.

    An interrupted run goes on where it was. Results are kept with hashes of what
    made them: settings, the program's source, and versions of packages. If one
    of these has changed, the command refuses the folder: give a new one. Other
    seeds and tasks can share a folder.

    With the extra fast, long studies are driven by compiled loops with equal
    results (--engine).

    Settings were searched on seeds 0 to 79 and worlds rooms-0 to rooms-59. With
    one of those, or with fewer than 20 robots, nothing is judged. A robot's seed
    decides its generated worlds; 20 consecutive seeds share all of them.

    For example:

        kurt2rt study paper --quick
        kurt2rt study paper --task circle --task eight
    """
    # Not at the top: the simulator is an extra, and `kurt2rt run` on the robot does without it.
    from kurt2rt.experiments.paper.figures import draw_figures
    from kurt2rt.experiments.paper.settings import QUICK, WHOLE, load_paper
    from kurt2rt.experiments.paper.study import make_plan
    from kurt2rt.experiments.paper.tables import all_tables, read_study, reasons_not_to_judge, write_paper

    seeds = options.seeds or (_QUICK_SEEDS if options.quick else _SEEDS)
    folder = options.out or (_QUICK_FOLDER if options.quick else _FOLDER)
    parts = job_parts(load_robot(), folder)
    plan = make_plan(
        load_paper(factory=parts["factory"]).model_copy(update={"teacher": options.teacher}),
        QUICK if options.quick else WHOLE,
        parse_seeds(seeds),
        ("shipped", "plain") if options.paper_defaults else ("shipped",),
        parts,
        tasks=options.task or (),
        engine=options.requested_engine(),
    )
    command = typed_command("study paper", options, {"seeds": seeds})
    with study_run(plan, parts, options) as bar:
        bar.say("figures and report")
        study, report = read_study(plan), folder / "report.html"
        write_paper(study, list(draw_figures(study, parts["factory"], folder)), command, report)
    print_study(all_tables(study), reasons_not_to_judge(plan), as_json=options.as_json, report=report)
