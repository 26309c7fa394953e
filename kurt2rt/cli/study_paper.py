"""`kurt2rt study paper` and `phases`: the experiments of the paper, each with its report."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hal.robot_settings import load_robot
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.options import DEFAULT_TEACHER, Teacher, parse_seeds, results_option, seeds_option, task_option
from kurt2rt.cli.study_run import EngineOptions, TaskOptions, job_parts, run_study
from kurt2rt.cli.typed_command import typed_command

# Studies are imported in their commands: simulator and drawing are extras, and all commands are loaded for --help.

Quick = Annotated[bool, typer.Option("--quick", help="A small part in under a minute; its numbers say nothing.")]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Paper(EngineOptions):
    quick: Quick = False
    seeds: Annotated[str | None, seeds_option("100-119", "100-101")] = None
    task: Annotated[list[str] | None, task_option("Repeat for several. Default: all tasks of config/paper.")] = None
    teacher: Teacher = DEFAULT_TEACHER
    out: Annotated[Path | None, results_option("results/paper, with --quick results/paper-quick")] = None
    paper_defaults: Annotated[
        bool,
        typer.Option("--paper-defaults/--no-paper-defaults", help="Also do all of it with the paper's own settings."),
    ] = True


@takes_options(_Paper)
def paper(options: _Paper) -> None:
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
    from kurt2rt.experiments.paper.settings import QUICK, WHOLE, load_paper
    from kurt2rt.experiments.paper.study import make_plan
    from kurt2rt.experiments.paper.tables import tell

    seeds = options.seeds or ("100-101" if options.quick else "100-119")
    parts = job_parts(load_robot(), options.out or Path("results/paper-quick" if options.quick else "results/paper"))
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
    run_study(plan, options, lambda _: tell(plan, parts["factory"], command))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Phases(TaskOptions):
    quick: Quick = False
    seeds: Annotated[str | None, seeds_option("100-119", "0-1")] = None
    out: Annotated[Path | None, results_option("results/phases/ and the task's name, with -quick behind it")] = None


@takes_options(_Phases)
def phases(options: _Phases) -> None:
    """Train robots through phases 1 to 5, next to controls.

    In phase 1 the teacher answers, in 2 corrects, in 3 rewards, and in 4 teaches
    a critic. In phase 5 the robot goes on alone. An exam follows each phase, and
    a long run the last. The controls begin with the knowledge of phase 2, some
    of its actions made wrong. They show how much each phase repairs. The task
    needs a section `phases`.

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
    from kurt2rt.experiments.phases.study import make_plan
    from kurt2rt.experiments.phases.tables import tell

    seeds = options.seeds or ("0-1" if options.quick else "100-119")
    task, robot = options.load()
    parts = job_parts(robot, options.out or Path("results/phases") / (task.name + ("-quick" if options.quick else "")))
    plan = make_plan(task, parse_seeds(seeds), parts, quick=options.quick, engine=options.requested_engine())
    command = typed_command("study phases", options, {"task": options.task, "seeds": seeds})
    run_study(plan, options, lambda _: tell(plan, command))
