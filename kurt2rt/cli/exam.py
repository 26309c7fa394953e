"""`kurt2rt exam`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.interrupt import end_at_interrupt
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.options import (
    Changes,
    PaperDefaults,
    RobotName,
    Seed,
    TaskOfTheFile,
    changes_of,
    refuse_if,
    world_option,
)
from kurt2rt.cli.tables import console_of
from kurt2rt.platform.text_table import print_whole


@dataclass(frozen=True, slots=True)
class _Options:
    knowledge: Annotated[
        list[Path], typer.Argument(help="Knowledge files, as kurt2rt train or kurt2rt run leaves them.")
    ]
    task: TaskOfTheFile = None
    paper_defaults: PaperDefaults = False
    changes: Changes = None
    seed: Seed = 1
    world: Annotated[
        list[str] | None,
        world_option("Repeat for several. Default: the worlds of the task."),
    ] = None
    broken: Annotated[
        str | None,
        typer.Option(
            "--broken-sensor",
            metavar="SENSOR=FAULT",
            help="Break a range sensor of the robot after 2 s, such as s15=low. Faults: low, high, frozen, unplugged, "
            "dark and phantom.",
        ),
    ] = None
    robot_settings: RobotName = None
    as_json: AsJson = False


@takes_options(_Options)
def exam(options: _Options) -> None:
    """Examine knowledge: a simulated robot drives by itself.

    The teacher's own policy drives for comparison, from the same start. In a
    situation that it does not know, the robot stands. If it gets nowhere for
    long, it is stuck, and the exam in this world ends.

    The task comes from the knowledge file.

    For example:

        kurt2rt exam results/demo/wall_following-1.knowledge
        kurt2rt exam mine.knowledge --world b --world rooms-200
        kurt2rt exam var/class/robot-*/*.knowledge
    """
    refuse_if(options.as_json and len(options.knowledge) > 1, "as JSON, one knowledge file at a time", "--json")
    for knowledge in options.knowledge:
        _exam(options, knowledge)


def _exam(options: _Options, knowledge: Path) -> None:
    with end_at_interrupt():  # not at the top: a shell waits for the options alone, for --help and at each Tab
        from hal.robot_settings import load_robot_of
        from kurt2rt.cli.progress import job_bars
        from kurt2rt.core.task_robot import require_robot_of
        from kurt2rt.core.task_settings import load_task
        from kurt2rt.experiments.study.exam_tables import exam_tables, exams_as_data
        from kurt2rt.experiments.study.examination import examine_file
        from kurt2rt.experiments.study.table import as_rich
        from kurt2rt.knowledge.files.task_of_file import task_of_file

    task_name = options.task or task_of_file(knowledge)
    settings = load_robot_of(options.robot_settings, task_name)
    other = changes_of(options.changes)
    taught = load_task(task_name, paper_defaults=options.paper_defaults, changes=other)
    require_robot_of(taught, task_name, settings)
    if options.task is not None:
        task_of_file(knowledge, options.task)
    with job_bars() as report:
        results = examine_file(
            knowledge,
            settings,
            taught,
            options.seed,
            report,
            worlds=options.world or (),
            broken=options.broken,
        )
    if options.as_json:
        print_json({"knowledge": knowledge, "seed": options.seed, **exams_as_data(results, taught)})
    else:
        name = [f"\n{knowledge}"] if len(options.knowledge) > 1 else []
        print_whole(console_of(), *name, *map(as_rich, exam_tables(results, taught)))
