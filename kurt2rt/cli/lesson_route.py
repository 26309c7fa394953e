"""`kurt2rt lesson route`: robots that know the streets are taught routes through them."""

import anyio
import typer

from behaviors.metrics.route import RouteSettings
from kurt2rt.cli.json_output import print_json
from kurt2rt.cli.lesson_options import ROUTES, LessonOptions, LessonSetup
from kurt2rt.cli.progress import job_bars
from kurt2rt.cli.study_run import study_run
from kurt2rt.cli.tables import console_of, print_study, tables_of
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.lockstep.curriculum import Report, run_lesson
from kurt2rt.experiments.route.lesson import TaughtRoute, teach_route, with_route
from kurt2rt.experiments.route.plan import basic_file, basic_task_of, decisions_of, make_plan
from kurt2rt.experiments.route.summary import read_study
from kurt2rt.experiments.route.tables import all_tables, robot_table
from kurt2rt.experiments.route.variants import CONTROLS, TAUGHT
from kurt2rt.experiments.study.eligibility import reasons_against_judging
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.table import as_rich
from kurt2rt.knowledge.files.archive_existing import archive_existing
from kurt2rt.knowledge.journal.loading import copy_knowledge
from kurt2rt.platform.text_table import print_whole


def teaches_route(task: TaskSettings) -> bool:
    """Return whether the task teaches a route."""
    return isinstance(task.course, RouteSettings)


def require_no_route_options(task: TaskSettings, options: LessonOptions) -> None:
    """Raise typer.BadParameter if the options include one that only a task with a route has."""
    for name, value in {"--decisions": options.decisions, "--basic": options.basic}.items():
        if value:
            raise typer.BadParameter(f"task {task.name} teaches no route; leave it out", param_hint=name)
    if options.controls and options.seeds is None:
        raise typer.BadParameter("teachers are compared over many seeds; give --seeds, too", param_hint="--controls")


def one_route(setup: LessonSetup, options: LessonOptions) -> None:
    """Teach one robot one route, examine it, print the numbers and draw the drive.

    Raises:
        typer.BadParameter: options do not fit.
        SettingsError: task, robot or world cannot be loaded, or do not fit.
        StudyError: the knowledge file of the streets is missing.
        KnowledgeError: a knowledge file cannot be read or written.
    """
    # Not at the top: drawing is an extra, and every command is loaded where --help is said.
    from kurt2rt.experiments.route.figures import draw_route

    given_decisions = tuple(options.decisions or ())
    if len(given_decisions) > 1 or options.controls:
        raise typer.BadParameter("one robot is taught one route; give --seeds, too", param_hint="--decisions")
    factory, seed, out = setup.factory, options.seed, options.out or ROUTES
    task = with_route(setup.task, seed, *given_decisions)
    worlds = (task.teaching.world, *task.exam.worlds[:1])
    factory.require_worlds(*worlds)
    require_course(factory, task, worlds)
    (decisions,) = decisions_of(task, given_decisions)
    basic = basic_task_of(task)
    given = None if options.basic is None else basic_file(options.basic, basic, seed)
    out.mkdir(parents=True, exist_ok=True)
    stem = f"{task.name}-{decisions}-{seed}"
    file = options.knowledge or out / f"{stem}.knowledge"
    if options.knowledge is None:
        archive_existing(file)

    async def run(report: Report) -> TaughtRoute:
        if not file.exists():
            streets = given or out / f"{basic.name}-{seed}.knowledge"
            if given is None:
                archive_existing(streets)
                await run_lesson(factory, setup.robot, basic, streets, seed=seed, report=report)
            copy_knowledge(streets, file)
        return await teach_route(factory, setup.robot, task, TAUGHT, file, seed=seed, report=report)

    with job_bars() as report:
        outcome = anyio.run(run, report).outcome()
    picture = out / f"{stem}.png"
    draw_route(factory, task.exam.worlds[0], outcome, picture)
    if options.as_json:
        print_json({"tables": tables_of([robot_table(outcome, task)]), "knowledge": file, "picture": picture})
        return
    files = (f"{what}  {path}" for what, path in (("knowledge", file), ("picture", picture)))
    print_whole(console_of(), as_rich(robot_table(outcome, task)), *files)


def many_routes(setup: LessonSetup, options: LessonOptions) -> None:
    """Teach and examine many robots; keep results that are in the folder. Print tables and write a report.

    Raises:
        SettingsError: task, robot or world cannot be loaded.
        StudyError: another run writes to the folder, or it has results of other settings.
        KnowledgeError: a knowledge file of the streets cannot be read.
    """
    from kurt2rt.experiments.route.figures import draw_figures
    from kurt2rt.experiments.route.report import write_report

    factory, task = setup.factory, setup.task
    results = Results(options.out or ROUTES)
    plan = make_plan(
        task,
        basic_task_of(task),
        options.all_seeds,
        decisions_of(task, options.decisions or ()),
        (TAUGHT, *(CONTROLS if options.controls else ())),
        JobParts(factory=factory, robot=setup.robot, results=results),
        basic_folder=options.basic,
    )
    with study_run(plan, results, options.jobs, options.on) as bar:
        bar.say("pictures and report")
        study = read_study(plan, results)
        pictures = list(draw_figures(study, factory, results.folder))
        report = results.folder / "report.html"
        write_report(study, pictures, setup.command, report)
    print_study(all_tables(study), reasons_against_judging(plan.seeds), report, as_json=options.as_json)
