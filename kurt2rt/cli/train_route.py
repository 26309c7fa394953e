"""`kurt2rt train` of route and errands: robots that know the streets are taught routes, or sent to places."""

import anyio

from kurt2rt.cli.options import refuse_if
from kurt2rt.cli.progress import job_bars
from kurt2rt.cli.study_run import job_parts, run_study
from kurt2rt.cli.tables import print_told
from kurt2rt.cli.train_options import ERRANDS, ROUTES, TrainOptions, TrainSetup
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.route.study import BasicJob, RouteJob, RouteOutcome, make_plan
from kurt2rt.experiments.study.table import Told
from kurt2rt.knowledge.files.archive_existing import archive_existing
from kurt2rt.knowledge.journal.loading import copy_knowledge


def require_no_route_options(task: TaskSettings, options: TrainOptions) -> None:
    """Raise typer.BadParameter if the options include one that only a task with a route has."""
    of_a_route = {"--decisions": options.decisions, "--basic": options.basic}
    for name, value in of_a_route.items():
        refuse_if(bool(value), f"task {task.name} teaches no route; leave it out", name)


def one_route(setup: TrainSetup, options: TrainOptions) -> None:
    """Teach one robot one route, examine it, print the numbers and draw the drive.

    Raises:
        typer.BadParameter: options do not fit.
        SettingsError: task, robot or world cannot be loaded, or do not fit.
        StudyError: the knowledge file of the streets is missing.
        KnowledgeError: a knowledge file cannot be read or written.
    """
    # Not at the top: drawing is an extra, and every command is loaded where --help is said.
    from kurt2rt.experiments.route.tables import draw_route, robot_table

    given = tuple(options.decisions or ())
    refuse_if(len(given) > 1, "one robot is taught one route; give --seeds, too", "--decisions")
    out = options.out or ROUTES
    plan = make_plan(setup.task, (options.seed,), given, job_parts(setup.robot, out), basic_folder=options.basic)
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
    told = Told([robot_table(outcome, task)], files={"knowledge": file, "picture": picture})
    print_told(told, as_json=options.as_json)


def many_routes(setup: TrainSetup, options: TrainOptions) -> None:
    """Teach and examine many robots; keep results that are in the folder. Print tables and write a report.

    Raises the errors of `one_route`, and StudyError if another run writes to the folder, or it has results of other
    settings.
    """
    from kurt2rt.experiments.route.tables import tell

    parts = job_parts(setup.robot, options.out or ROUTES)
    plan = make_plan(setup.task, options.all_seeds, options.decisions or (), parts, basic_folder=options.basic)
    run_study(plan, options, lambda _: tell(plan, setup.command))


def errands(setup: TrainSetup, options: TrainOptions) -> None:
    """Lead robots through a town and send them to places; print tables and draw each robot.

    Raises the errors of `many_routes`, and typer.BadParameter if an option belongs to other tasks.
    """
    from kurt2rt.experiments.navigation.study import make_plan, tell

    given = bool(options.decisions) or options.knowledge is not None
    refuse_if(given, "errands take neither of these; leave them out", "--decisions, --knowledge")
    plan = make_plan(
        setup.task, options.all_seeds, job_parts(setup.robot, options.out or ERRANDS), basic_folder=options.basic
    )
    run_study(plan, options, lambda _: tell(plan, setup.command))
