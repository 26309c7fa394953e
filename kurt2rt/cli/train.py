"""`kurt2rt train`."""

from pathlib import Path

import anyio

from behaviors.metrics.errands import ErrandsSettings
from behaviors.metrics.route import RouteSettings
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.json_output import print_json
from kurt2rt.cli.options import changes_of, refuse_if
from kurt2rt.cli.progress import job_bars
from kurt2rt.cli.study_run import job_parts, run_study
from kurt2rt.cli.tables import console_of, say
from kurt2rt.cli.train_options import DEFAULT_TASK, FOLDER, TrainOptions, TrainSetup
from kurt2rt.cli.train_route import errands, many_routes, one_route, require_no_route_options
from kurt2rt.cli.typed_command import typed_command
from kurt2rt.core.task_robot import load_task_and_robot
from kurt2rt.core.task_settings import taught_by_named
from kurt2rt.experiments.lockstep.compatibility import require_actions
from kurt2rt.experiments.lockstep.curriculum import Report, run_lesson
from kurt2rt.experiments.lockstep.drive_row import label_of
from kurt2rt.experiments.lockstep.lesson import LessonCounts
from kurt2rt.experiments.study.exam_tables import by_world, curriculum_as_data, lesson_table, seeds_tables, success_text
from kurt2rt.experiments.study.jobs import require_places
from kurt2rt.experiments.study.seeds import forget_lost_robots, forget_result, make_plan, read_results
from kurt2rt.experiments.study.study_plan import EngineRequest
from kurt2rt.experiments.study.table import Told, as_rich
from kurt2rt.knowledge.files.archive_existing import archive_existing
from kurt2rt.knowledge.files.task_of_file import task_of_file
from kurt2rt.platform.text_table import print_whole
from simbridge.contracts.robot_kind import simulations_of


@takes_options(TrainOptions)
def train(options: TrainOptions) -> None:
    """Teach simulated robots with a scripted teacher.

    One lesson lasts as long as its task says (config/tasks), in robot time.
    Settings were searched on seeds 0 to 79 and worlds rooms-0 to rooms-59;
    results are reported on others:

        kurt2rt train --task streets --seeds 100-119

    The default teacher, ordinary, reacts, errs and looks away like a person;
    superhuman reacts faster and never errs (config/teachers):

        kurt2rt train --teacher superhuman --seeds 100-119

    With --seeds the results are kept in --out, so an interrupted run goes on
    where it was. If the settings or the program changed since, a robot is taught
    again, and its old knowledge file is renamed.

    The task route teaches the mid level a closed loop through the streets, which
    the robot's seed draws. Then the robot drives it without a teacher:

        kurt2rt train --task route
        kurt2rt train --task route --seeds 0-9 --decisions 8 --decisions 12

    The task errands leads the robot through the town and names places. Then it
    sends the robot to them, along routes it was never shown in one piece:

        kurt2rt train --task errands --seeds 0-9
    """
    setup = _setup(_task_name(options), options)
    task = setup.task
    compiled, many = options.engine is EngineRequest.COMPILED, options.seeds is not None
    refuse_if(compiled and not many, "compiled is for many robots: give --seeds as well", "--engine")
    of_one = many and options.knowledge is not None
    refuse_if(of_one, "each seed needs a file of its own: give --out instead", "--knowledge")
    if task.mid is not None and compiled:
        say(f"{task.name}: lessons and exams on the CAN bus, because a batch does not know a mid level", stderr=True)
    if isinstance(task.metric, ErrandsSettings):
        errands(setup, options)
    elif not isinstance(task.metric, RouteSettings):
        require_no_route_options(task, options)
        _basic_task(setup, options)
    elif options.seeds is None:
        one_route(setup, options)
    else:
        many_routes(setup, options)


def _task_name(options: TrainOptions) -> str:
    """Return the task: of --task, or of the file in --knowledge. Raises KnowledgeError."""
    if options.knowledge is not None and options.knowledge.exists():
        return task_of_file(options.knowledge, options.task)
    return options.task or DEFAULT_TASK


def _setup(task_name: str, options: TrainOptions) -> TrainSetup:
    changes = changes_of(options.changes)
    if options.until_right:
        changes["teaching.until_right"] = "true"
    task, robot = load_task_and_robot(
        task_name, options.robot_settings, paper_defaults=options.paper_defaults, changes=changes
    )
    taught = taught_by_named(task, options.teacher)
    command = typed_command("train", options, {"task": task_name})
    return TrainSetup(simulations_of(robot), robot, taught, command)


def _basic_task(setup: TrainSetup, options: TrainOptions) -> None:
    task, out = setup.task, options.out or FOLDER
    worlds = (task.teaching.world, *(task.exam.worlds if options.seeds is not None else ()))
    require_places(setup.factory, task, worlds)
    require_actions(task, setup.robot)
    if options.seeds is None:
        _one_seed(setup, options, out)
    else:
        _many_seeds(setup, options, out)


def _one_seed(setup: TrainSetup, options: TrainOptions, out: Path) -> None:
    task = setup.task
    out.mkdir(parents=True, exist_ok=True)
    file = options.knowledge or out / f"{task.name}-{options.seed}.knowledge"
    if options.knowledge is None:
        archive_existing(file)
        forget_result(out, task.name, options.seed)

    async def run(report: Report) -> LessonCounts:
        given = await run_lesson(setup.factory, setup.robot, task, file, seed=options.seed, report=report)
        return given.result.counts

    with job_bars() as report:
        lesson = anyio.run(run, report)
    if options.as_json:
        print_json({**curriculum_as_data(lesson, (), task), "knowledge": file})
    else:
        print_whole(console_of(), as_rich(lesson_table(lesson, task)), f"knowledge  {file}")


def _many_seeds(setup: TrainSetup, options: TrainOptions, out: Path) -> None:
    # Not at the top: reports are an extra, and one robot is taught without it.
    from kurt2rt.experiments.study.figures import draw_passed
    from kurt2rt.experiments.study.report import tell_with_report

    parts = job_parts(setup.robot, out)
    plan = make_plan(setup.task, options.all_seeds, parts, engine=options.requested_engine())
    forget_lost_robots(plan)

    def tell(_: object) -> Told:
        robots, task = read_results(plan), setup.task
        data = [curriculum_as_data(each.lesson, each.drives, task) for each in robots]
        told = {"task": task.name, "teacher": task.teaching.profile.name, "robots": data}
        tables = list(seeds_tables(robots, task))
        drives = [drive for each in robots for drive in each.drives]
        worlds = {f"world {label_of(each.world)}": each.rows for each in by_world(None, drives)}
        picture = draw_passed(worlds, f"{len(robots)} robots, one for each seed.", out / f"{task.name}.png")
        result = Told(tables, f"Exams passed without a teacher: {success_text(drives)}.", short=tables[2], data=told)
        title = f"KURT2: {task.name} taught to {len(robots)} robots"
        return tell_with_report(out, title, result, setup.command, [picture])

    run_study(plan, options, tell)
