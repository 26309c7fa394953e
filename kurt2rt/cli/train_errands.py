"""`kurt2rt train --task errands`: robots that know the streets are led about a town, and sent to places."""

import typer

from behaviors.metrics.errands import ErrandsSettings
from kurt2rt.cli.json_output import print_json
from kurt2rt.cli.study_run import study_run
from kurt2rt.cli.tables import console_of, tables_of
from kurt2rt.cli.train_options import ERRANDS, TrainOptions, TrainSetup
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.navigation.guided_tour import navigation_settings
from kurt2rt.experiments.navigation.study import ErrandsOutcome, NavigationJob, make_plan
from kurt2rt.experiments.study.table import as_rich
from kurt2rt.platform.text_table import print_whole


def runs_errands(task: TaskSettings) -> bool:
    """Return whether the task sends the robot to places of a town."""
    return isinstance(task.metric, ErrandsSettings)


def errands(setup: TrainSetup, options: TrainOptions) -> None:
    """Lead robots through a town and send them to places; print tables and draw each robot.

    Results that are in the folder already are kept.

    Raises:
        typer.BadParameter: an option belongs to other tasks.
        SettingsError: task, robot or world cannot be loaded.
        StudyError: another run writes to the folder, or it has results of other settings.
        KnowledgeError: a knowledge file of the streets cannot be read.
    """
    # Not at the top: drawing is an extra, and every command is loaded where --help is said.
    from kurt2rt.experiments.navigation.tables import all_tables, draw_errands

    if options.decisions or options.knowledge is not None:
        raise typer.BadParameter("errands take neither --decisions nor --knowledge; leave them out")
    task, out = setup.task, options.out or ERRANDS
    parts = setup.parts(out)
    plan = make_plan(task, options.all_seeds, parts, basic_folder=options.basic)
    with study_run(plan, parts, options) as bar:
        bar.say("pictures")
        outcomes = [job.results.read(job, ErrandsOutcome) for job in plan.of(NavigationJob)]
        pictures = []
        for outcome in outcomes:
            pictures.append(out / f"{task.name}-{outcome.seed}.png")
            draw_errands(setup.factory, task.exam.worlds[0], outcome, pictures[-1])
    tables = list(all_tables(outcomes, navigation_settings(task), task.teaching.profile.name))
    if options.as_json:
        print_json({"tables": tables_of(tables), "pictures": pictures})
        return
    pictures_told = f"pictures  {pictures[0]}{' ...' if len(pictures) > 1 else ''}"
    print_whole(console_of(), *map(as_rich, tables), pictures_told)
