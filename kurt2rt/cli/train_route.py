"""`kurt2rt train --task route`: robots that know the streets are taught routes through them."""

import anyio
import typer

from behaviors.metrics.route import RouteSettings
from kurt2rt.cli.json_output import print_json
from kurt2rt.cli.progress import job_bars
from kurt2rt.cli.study_run import study_run
from kurt2rt.cli.tables import console_of, print_study, tables_of
from kurt2rt.cli.train_options import ROUTES, TrainOptions, TrainSetup
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.route.study import BasicJob, RouteJob, RouteOutcome, make_plan
from kurt2rt.experiments.study.table import as_rich
from kurt2rt.experiments.study.targets import reasons_against_judging
from kurt2rt.knowledge.files.archive_existing import archive_existing
from kurt2rt.knowledge.journal.loading import copy_knowledge
from kurt2rt.platform.text_table import print_whole


def teaches_route(task: TaskSettings) -> bool:
    """Return whether the task teaches a route."""
    return isinstance(task.metric, RouteSettings)


def require_no_route_options(task: TaskSettings, options: TrainOptions) -> None:
    """Raise typer.BadParameter if the options include one that only a task with a route has."""
    of_a_route = {"--decisions": options.decisions, "--basic": options.basic}
    for name, value in of_a_route.items():
        if value:
            raise typer.BadParameter(f"task {task.name} teaches no route; leave it out", param_hint=name)


def one_route(setup: TrainSetup, options: TrainOptions) -> None:
    """Teach one robot one route, examine it, print the numbers and draw the drive.

    Raises:
        typer.BadParameter: options do not fit.
        SettingsError: task, robot or world cannot be loaded, or do not fit.
        StudyError: the knowledge file of the streets is missing.
        KnowledgeError: a knowledge file cannot be read or written.
    """
    # Not at the top: drawing is an extra, and every command is loaded where --help is said.
    from kurt2rt.experiments.route.figures import draw_route
    from kurt2rt.experiments.route.tables import robot_table

    given = tuple(options.decisions or ())
    if len(given) > 1:
        raise typer.BadParameter("one robot is taught one route; give --seeds, too", param_hint="--decisions")
    out = options.out or ROUTES
    plan = make_plan(setup.task, (options.seed,), given, setup.parts(out), basic_folder=options.basic)
    (job,), task = plan.of(RouteJob), plan.of(RouteJob)[0].task
    out.mkdir(parents=True, exist_ok=True)
    stem = f"{task.name}-{job.decisions}-{job.seed}"
    file = options.knowledge or out / f"{stem}.knowledge"
    if options.knowledge is None:
        archive_existing(file)

    async def run(report: Report) -> RouteOutcome:
        if not file.exists():
            streets = job.basic
            for basic in plan.of(BasicJob):
                streets = out / f"{basic.task.name}-{basic.seed}.knowledge"
                archive_existing(streets)
                await basic.teach(streets, report)
            copy_knowledge(streets, file)
        return await job.teach_route(file, report)

    with job_bars() as report:
        outcome = anyio.run(run, report)
    picture = out / f"{stem}.png"
    draw_route(setup.factory, outcome, picture)
    table = robot_table(outcome, task)
    if options.as_json:
        print_json({"tables": tables_of([table]), "knowledge": file, "picture": picture})
    else:
        print_whole(console_of(), as_rich(table), f"knowledge  {file}", f"picture  {picture}")


def many_routes(setup: TrainSetup, options: TrainOptions) -> None:
    """Teach and examine many robots; keep results that are in the folder. Print tables and write a report.

    Raises:
        SettingsError: task, robot or world cannot be loaded.
        StudyError: another run writes to the folder, or it has results of other settings.
        KnowledgeError: a knowledge file of the streets cannot be read.
    """
    from kurt2rt.experiments.route.figures import draw_figures
    from kurt2rt.experiments.route.tables import all_tables, read_study, write_routes

    parts = setup.parts(options.out or ROUTES)
    plan = make_plan(setup.task, options.all_seeds, options.decisions or (), parts, basic_folder=options.basic)
    with study_run(plan, parts, options) as bar:
        bar.say("pictures and report")
        study, folder = read_study(plan), parts["results"].folder
        pictures = list(draw_figures(study, setup.factory, folder))
        report = folder / "report.html"
        write_routes(study, pictures, setup.command, report)
    print_study(all_tables(study), reasons_against_judging(plan.seeds), as_json=options.as_json, report=report)
