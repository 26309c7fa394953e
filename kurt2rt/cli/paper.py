"""`kurt2rt paper`."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hal.robot_kind import simulations_of
from hal.robot_settings import load_robot
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.executor_option import OnOption
from kurt2rt.cli.json_output import AsJson
from kurt2rt.cli.loop_options import ExamsOption, LessonsOption, requested_loops
from kurt2rt.cli.options import (
    ALL_PROCESSORS,
    DEFAULT_OF_THE_TASK,
    Jobs,
    parse_seeds,
    results_option,
    seeds_option,
    task_option,
    teacher_option,
)
from kurt2rt.cli.study_run import study_run
from kurt2rt.cli.tables import print_study
from kurt2rt.cli.typed_command import typed_command
from kurt2rt.experiments.study.loop_choice import LoopRequest

if TYPE_CHECKING:
    from kurt2rt.experiments.paper.outcome import Reading

_SEEDS, _QUICK_SEEDS = "100-119", "100-101"
_FOLDER, _QUICK_FOLDER = Path("results/paper"), Path("results/paper-quick")


@dataclass(frozen=True, slots=True)
class _Options:
    """Options of `kurt2rt paper`."""

    quick: Annotated[
        bool, typer.Option("--quick", help="A small part in under a minute: fewer tasks and seeds, short lessons.")
    ] = False
    seeds: Annotated[str | None, seeds_option(_SEEDS, _QUICK_SEEDS)] = None
    task: Annotated[
        list[str] | None,
        task_option("Repeat for several. Default: all tasks of config/paper."),
    ] = None
    teacher: Annotated[str | None, teacher_option(DEFAULT_OF_THE_TASK)] = None
    jobs: Jobs = ALL_PROCESSORS
    on: OnOption = None
    lessons: LessonsOption = LoopRequest.AUTO
    exams: ExamsOption = LoopRequest.AUTO
    out: Annotated[Path | None, results_option(f"{_FOLDER}, with --quick {_QUICK_FOLDER}")] = None
    plain: Annotated[
        bool, typer.Option("--plain/--no-plain", help="Also do all of it in the plain reading of the paper.")
    ] = True
    as_json: AsJson = False


@takes_options(_Options)
def paper(options: _Options) -> None:
    """Teach the tasks of the paper, and compare the results.

    Leaves report.html, which holds everything, the figures as PNG, and each
    robot's result and knowledge file in the output folder.

    A run that was interrupted goes on where it was. Results are kept with hashes
    of what made them: settings of task, robot and worlds, the program's source,
    and the versions of what computes. When one of these has changed, what is in
    the folder is refused and not mixed in: give a new folder. Other seeds and
    other tasks may share a folder.

    Compiled loops drive the tasks that they know, if the extra fast is installed
    and the study is long, with equal results (--lessons, --exams).

    Settings were searched on seeds 0 to 79 and worlds rooms-0 to rooms-59; these
    robots and worlds are others. With one of those, or with fewer than 20
    robots, nothing is judged. Which generated worlds a robot drives in follows
    from its seed; 20 seeds that follow each other share all of them.

    For example:

        kurt2rt paper --quick
        kurt2rt paper --task circle --task eight
    """
    _run_study(options)


def _run_study(options: _Options) -> None:
    # Not at the top: the simulator is an extra, and `kurt2rt run` on the robot does without it.
    from kurt2rt.experiments.paper.eligibility import reasons_not_to_judge
    from kurt2rt.experiments.paper.extent import QUICK, WHOLE
    from kurt2rt.experiments.paper.figures import draw_figures
    from kurt2rt.experiments.paper.plan import make_plan
    from kurt2rt.experiments.paper.report import write_report
    from kurt2rt.experiments.paper.settings import load_paper
    from kurt2rt.experiments.paper.summary import read_study
    from kurt2rt.experiments.paper.tables import all_tables
    from kurt2rt.experiments.study.jobs import JobParts
    from kurt2rt.experiments.study.results import Results

    typed_seeds = options.seeds or (_QUICK_SEEDS if options.quick else _SEEDS)
    robot = load_robot()
    stage = simulations_of(robot)
    results = Results(options.out or (_QUICK_FOLDER if options.quick else _FOLDER))
    readings: tuple[Reading, ...] = ("shipped", "plain") if options.plain else ("shipped",)
    extent = QUICK if options.quick else WHOLE
    plan = make_plan(
        load_paper(factory=stage).model_copy(update={"teacher": options.teacher}),
        extent,
        parse_seeds(typed_seeds),
        readings,
        JobParts(factory=stage, robot=robot, results=results),
        tasks=options.task or (),
        loops=requested_loops(options.lessons, options.exams),
    )
    command = typed_command("paper", options, {"seeds": typed_seeds})
    with study_run(plan, results, options.jobs, options.on, choice=plan.choice) as bar:
        bar.say("figures and report")
        study = read_study(plan, results)
        pictures = list(draw_figures(study, stage, results.folder))
        report = results.folder / "report.html"
        write_report(study, pictures, command, report)
    print_study(all_tables(study), reasons_not_to_judge(plan), report, as_json=options.as_json)
