"""`kurt2rt demo`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.interrupt import end_at_interrupt
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.options import (
    DEFAULT_TEACHER,
    Changes,
    OutFolder,
    PaperDefaults,
    RobotName,
    Seed,
    Teacher,
    changes_of,
    task_option,
)
from kurt2rt.cli.tables import console_of
from kurt2rt.platform.text_table import print_whole


@dataclass(frozen=True, slots=True)
class _Options:
    task: Annotated[str, task_option("Default: wall_following.")] = "wall_following"
    teacher: Teacher = DEFAULT_TEACHER
    paper_defaults: PaperDefaults = False
    changes: Changes = None
    seed: Seed = 1
    out: OutFolder = Path("results/demo")
    robot_settings: RobotName = None
    as_json: AsJson = False


@takes_options(_Options)
def demo(options: _Options) -> None:
    """Teach a simulated robot from nothing, then examine it.

    A scripted teacher teaches over the same commands that a person uses, in
    simulated time and as fast as this machine allows: the robot asks where it
    knows nothing (phase 1), then is also corrected while it drives (phase 2).
    Then it drives without a teacher in each world of the task; in all but the
    first one it has never been.

    Leaves a picture of the drives and the knowledge file in the output folder.
    Look at the file with kurt2rt knowledge show.

    For example:

        kurt2rt demo
        kurt2rt demo --task circle --seed 7
    """
    with end_at_interrupt():  # not at the top: a shell waits for the options alone, for --help and at each Tab
        import anyio

        from kurt2rt.cli.progress import job_bars
        from kurt2rt.core.task_robot import load_task_and_robot
        from kurt2rt.core.task_settings import taught_by_named
        from kurt2rt.experiments.lockstep.compatibility import require_actions
        from kurt2rt.experiments.lockstep.curriculum import Report, run_exams, run_lesson
        from kurt2rt.experiments.lockstep.drawing import draw_curriculum
        from kurt2rt.experiments.lockstep.drive_row import DriveRow
        from kurt2rt.experiments.lockstep.lesson import TrainingResult
        from kurt2rt.experiments.study.exam_tables import curriculum_as_data, exam_tables, lesson_table
        from kurt2rt.experiments.study.jobs import require_places
        from kurt2rt.experiments.study.table import as_rich
        from kurt2rt.knowledge.files.archive_existing import archive_existing
        from simbridge.contracts.robot_kind import simulations_of

    task, settings = load_task_and_robot(
        options.task, options.robot_settings, paper_defaults=options.paper_defaults, changes=changes_of(options.changes)
    )
    taught = taught_by_named(task, options.teacher)
    stage = simulations_of(settings)
    worlds = (taught.teaching.world, *taught.exam.worlds)
    require_places(stage, taught, worlds)
    require_actions(taught, settings)
    options.out.mkdir(parents=True, exist_ok=True)
    stem = options.out / f"{taught.name}-{options.seed}"
    knowledge, picture = Path(f"{stem}.knowledge"), Path(f"{stem}.png")
    archive_existing(knowledge)

    async def run(report: Report) -> tuple[TrainingResult, tuple[DriveRow, ...]]:
        lesson, events = await run_lesson(stage, settings, taught, knowledge, seed=options.seed, report=report)
        exams = await run_exams(stage, settings, taught, events, taught.exam.worlds, seed=options.seed, report=report)
        return lesson, exams

    with job_bars() as report:
        lesson, exams = anyio.run(run, report)
    draw_curriculum(lesson, exams, taught, stage, picture)
    if options.as_json:
        print_json({**curriculum_as_data(lesson.counts, exams, taught), "picture": picture, "knowledge": knowledge})
        return
    files = (f"picture    {picture}", f"knowledge  {knowledge}")
    tables = (lesson_table(lesson.counts, taught), *exam_tables(exams, taught))
    print_whole(console_of(), *map(as_rich, tables), *files)
