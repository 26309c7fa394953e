"""`kurt2rt tune`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hal.robot_kind import simulations_of
from hal.robot_settings import load_robot
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.executor_option import OnOption, open_executor
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.options import (
    ALL_PROCESSORS,
    Changes,
    Jobs,
    changes_of,
    results_option,
    task_option,
    tuning_argument,
)
from kurt2rt.cli.progress import one_bar
from kurt2rt.cli.tables import console_of, tables_of
from kurt2rt.cli.typed_command import typed_command
from kurt2rt.experiments.study.pool import PoolProgress
from kurt2rt.platform.text_table import print_whole

_FOLDER = Path("results/tuning")


@dataclass(frozen=True, slots=True)
class _Options:
    """Arguments and options of `kurt2rt tune`."""

    league: Annotated[str, tuning_argument()]
    learner: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Rival; repeat for several. Default: all of the file.", show_default=False),
    ] = None
    task: Annotated[list[str] | None, task_option("Repeat for several. Default: all of the file.")] = None
    trials: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", help="Trials of each rival. Default: those of the file.", show_default=False),
    ] = None
    changes: Changes = None
    jobs: Jobs = ALL_PROCESSORS
    on: OnOption = None
    out: Annotated[Path | None, results_option(f"{_FOLDER}/ and the league's name")] = None
    as_json: AsJson = False


@takes_options(_Options)
def tune(options: _Options) -> None:
    """Search settings of rivals: the same number of trials on the same robots for each.

    A file of config/rivals names the robots and worlds, the keys of the task's
    file that are searched for all, and the gate of each learner. Each rival of
    each task has a search of its own, as `kurt2rt search` makes it, but without
    a check: the league examines all rivals on robots of its own.

    Leaves tuned.yaml in the output folder, which `kurt2rt rivals --tuned` takes.
    A tuning that was interrupted goes on where it was.

    For example, as far as two evenings go:

        kurt2rt tune presses --task wall_following --trials 12
        kurt2rt rivals --tuned results/tuning/presses/tuned.yaml
    """
    # Not at the top: simulator and Optuna are extras, and every command is loaded where --help is said.
    from kurt2rt.experiments.study.jobs import JobParts
    from kurt2rt.experiments.study.results import Results
    from kurt2rt.experiments.study.table import as_rich
    from kurt2rt.experiments.tuning.settings import load_tuning
    from kurt2rt.experiments.tuning.tuned_file import write_tuned
    from kurt2rt.experiments.tuning.tuning import plan_tuning, tuning_table

    settings, robot = load_tuning(options.league), load_robot()
    out, trials = options.out or _FOLDER / settings.name, options.trials or settings.trials
    parts = JobParts(factory=simulations_of(robot), robot=robot, results=Results(out))
    plans = [
        plan_tuning(settings, task, rival, parts, trials, changes_of(options.changes))
        for task in dict.fromkeys(options.task or settings.worlds)
        for rival in dict.fromkeys(options.learner or settings.rivals)
    ]
    found, done_s = [], 0.0
    with open_executor(options.on, options.jobs) as executor, one_bar(sum(each.robot_time_s for each in plans)) as bar:
        for each in plans:

            def update(told: PoolProgress, before_s: float = done_s) -> None:
                bar.update(told._replace(done_s=before_s + told.done_s))

            found.append(each.run(executor, update))
            done_s += each.robot_time_s
    path = out / "tuned.yaml"
    write_tuned(settings, trials, found, plans[0].plan.made_of, typed_command("tune", options), path)
    table = tuning_table(settings, trials, found)
    if options.as_json:
        print_json({"tables": tables_of([table]), "tuned": path})
        return
    print_whole(console_of(), as_rich(table), f"tuned   {path}")
