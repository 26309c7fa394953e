"""`kurt2rt lesson route`: robots that know the streets are taught routes through them."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import anyio
import typer

from behaviors.metrics.route import RouteSettings
from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.cli.json_output import print_json
from kurt2rt.cli.progress import job_bars, one_bar
from kurt2rt.cli.tables import console_of, print_study, tables_of
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.lockstep.curriculum import Report, run_lesson
from kurt2rt.experiments.route.lesson import TaughtRoute, copy_knowledge, teach_route, with_route
from kurt2rt.experiments.route.plan import basic_file, basic_task_of, decisions_of, make_plan
from kurt2rt.experiments.route.summary import read_study
from kurt2rt.experiments.route.tables import all_tables, robot_table
from kurt2rt.experiments.route.variants import CONTROLS, TAUGHT
from kurt2rt.experiments.study.eligibility import reasons_against_judging
from kurt2rt.experiments.study.plan import missing_time_s, run_missing
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.table import as_rich
from kurt2rt.knowledge.files.archive_existing import archive_existing
from kurt2rt.platform.text_table import print_whole

ROUTES = Path("results/route")
"""Where what is made goes, unless said otherwise."""


@dataclass(frozen=True, slots=True)
class RouteOptions:
    """What is said of routes alone."""

    decisions: tuple[int, ...] = ()
    """Empty: as many as the task says."""
    basic: Path | None = None
    """Knowledge of the streets, or a folder of such files; None: the streets are taught first."""
    controls: bool = False


def teaches_route(task: TaskSettings) -> bool:
    """Whether it is one of these."""
    return isinstance(task.course, RouteSettings)


def require_no_route_options(task: TaskSettings, options: RouteOptions) -> None:
    """Raises typer.BadParameter where something is said of routes for a task that teaches none."""
    said = {"--decisions": options.decisions, "--basic": options.basic, "--controls": options.controls}
    for name, value in said.items():
        if value:
            raise typer.BadParameter(f"task {task.name} teaches no route; leave it out", param_hint=name)


def one_route(
    factory: SimulationFactory,
    robot: RobotSettings,
    task: TaskSettings,
    options: RouteOptions,
    *,
    seed: int,
    knowledge: Path | None,
    out: Path,
    as_json: bool,
) -> None:
    """Teach one robot one route, examine it, print the numbers and draw the drive."""
    # Not at the top: drawing is an extra, and every command is loaded where --help is said.
    from kurt2rt.experiments.route.figures import draw_route

    if len(options.decisions) > 1 or options.controls:
        raise typer.BadParameter("one robot is taught one route; give --seeds, too", param_hint="--decisions")
    task = with_route(task, seed, *options.decisions)
    worlds = (task.teaching.world, *task.exam.worlds[:1])
    factory.require_worlds(*worlds)
    require_course(factory, task, worlds)
    (decisions,) = decisions_of(task, options.decisions)
    basic = basic_task_of(task)
    given = None if options.basic is None else basic_file(options.basic, basic, seed)
    out.mkdir(parents=True, exist_ok=True)
    stem = f"{task.name}-{decisions}-{seed}"
    file = knowledge or out / f"{stem}.knowledge"
    if knowledge is None:
        archive_existing(file)

    async def run(report: Report) -> TaughtRoute:
        if not file.exists():
            streets = given or out / f"{basic.name}-{seed}.knowledge"
            if given is None:
                archive_existing(streets)
                await run_lesson(factory, robot, basic, streets, seed=seed, report=report)
            copy_knowledge(streets, file)
        return await teach_route(factory, robot, task, TAUGHT, file, seed=seed, report=report)

    with job_bars() as report:
        outcome = anyio.run(run, report).outcome()
    picture = out / f"{stem}.png"
    draw_route(factory, task.exam.worlds[0], outcome, picture)
    if as_json:
        print_json({"tables": tables_of([robot_table(outcome, task)]), "knowledge": file, "picture": picture})
        return
    files = (f"{what}  {path}" for what, path in (("knowledge", file), ("picture", picture)))
    print_whole(console_of(), as_rich(robot_table(outcome, task)), *files)


def many_routes(
    factory: SimulationFactory,
    robot: RobotSettings,
    task: TaskSettings,
    options: RouteOptions,
    *,
    seeds: Sequence[int],
    jobs: int,
    out: Path,
    command: str,
    as_json: bool,
) -> None:
    """Teach and examine many robots; what is done already is kept. Prints tables and writes a report."""
    from kurt2rt.experiments.route.figures import draw_figures
    from kurt2rt.experiments.route.report import write_report

    results = Results(out)
    plan = make_plan(
        task,
        basic_task_of(task),
        seeds,
        decisions_of(task, options.decisions),
        (TAUGHT, *(CONTROLS if options.controls else ())),
        factory,
        robot,
        results,
        basic_folder=options.basic,
    )
    with results.held(), one_bar(missing_time_s(plan, results)) as bar:
        run_missing(plan, results, jobs, bar.look)
        bar.say("pictures and report")
        study = read_study(plan, results)
        pictures = list(draw_figures(study, factory, results.folder))
        report = results.folder / "report.html"
        write_report(study, pictures, command, report)
    print_study(all_tables(study), reasons_against_judging(plan.seeds), report, as_json=as_json)
