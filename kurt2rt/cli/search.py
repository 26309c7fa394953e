"""`kurt2rt study search`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hal.robot_settings import load_robot
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.json_output import print_json
from kurt2rt.cli.options import Changes, changes_of, results_option, search_argument
from kurt2rt.cli.progress import one_bar
from kurt2rt.cli.study_run import JobOptions, job_parts, open_executor, say_if_interpreted, says_how_to_go_on
from kurt2rt.cli.tables import console_of, tables_of
from kurt2rt.cli.typed_command import typed_command
from kurt2rt.platform.text_table import print_whole

_FOLDER = Path("results/search")


@dataclass(frozen=True, slots=True, kw_only=True)
class _Options(JobOptions):
    search: Annotated[str, search_argument()]
    trials: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", help="Number of trials. Default: that of the file.", show_default=False),
    ] = None
    changes: Changes = None
    out: Annotated[Path | None, results_option(f"{_FOLDER}/ and the search's name")] = None


@takes_options(_Options)
def search(options: _Options) -> None:
    """Search settings of a task on search seeds, and check the best once on other seeds and worlds.

    A file of config/searches names the keys and their ranges. It also names the
    teacher, and robots and worlds of search and check. Each trial teaches robots
    one after the other and examines them. It ends early if it cannot beat the
    median of the earlier trials. A better trial passes more exams, or as many
    with fewer presses.

    The best trials are then compared once with the shipped settings, robot by
    robot. Search seeds are 0 to 999 and 3000 to 3999; those of a check are
    others. Writes found.yaml (changed keys and their origin) and report.html to
    the output folder. --set changes all trials and the shipped settings.

    An interrupted search goes on where it was. The same file, number of trials
    and versions give the same trials, with any number of processes.

    For example:

        kurt2rt study search wall_following
        kurt2rt study search circle --trials 20 --jobs 2
    """
    # Not at the top: simulator, drawing and Optuna are extras, and every command is loaded where --help is said.
    from kurt2rt.experiments.lockstep.engine import Engine
    from kurt2rt.experiments.search.check import begin_check, check_time_s, require_unchecked, run_check
    from kurt2rt.experiments.search.plan import make_plan
    from kurt2rt.experiments.search.settings import load_search
    from kurt2rt.experiments.search.tables import all_tables, draw_trials, verdict_text, write_found, write_search
    from kurt2rt.experiments.search.trials import run_trials, trials_time_s
    from kurt2rt.experiments.study.bus_witness import require_no_difference
    from kurt2rt.experiments.study.table import as_rich

    settings = load_search(options.search)
    trials = options.trials or settings.trials
    parts = job_parts(load_robot(), options.out or _FOLDER / settings.name)
    results = parts["results"]
    plan = make_plan(settings, parts, changes=changes_of(options.changes))
    command = typed_command("study search", options)
    require_unchecked(plan, trials)
    if settings.engine is Engine.COMPILED:
        say_if_interpreted()
    trials_s = trials_time_s(plan, trials)
    whole_s = trials_s + check_time_s(plan)
    executors = open_executor(options.cluster, options.jobs)
    with says_how_to_go_on(results), executors as executor, results.held(), one_bar(whole_s) as bar:
        require_no_difference(results, {plan.made_of.source})
        made = run_trials(plan, trials, executor, bar.update)
        record = begin_check(plan, made, trials)
        check = run_check(
            plan, made, record, executor, lambda told: bar.update(told._replace(done_s=trials_s + told.done_s))
        )
        bar.say("figure and report")
        tables = all_tables(plan, made, check)
        picture = draw_trials(plan, made.all[:trials], plan.folder / "trials.png")
        found, report = plan.folder / "found.yaml", plan.folder / "report.html"
        write_found(plan, check, command, found)
        write_search(plan, check, tables, [picture], command, report)
    if options.as_json:
        better = None if check.found is None else check.found.label
        told = {"tables": tables_of(tables), "better": better, "verdict": verdict_text(plan, check)}
        print_json({**told, "found": found, "report": report})
        return
    print_whole(console_of(), *map(as_rich, tables), f"found   {found}", f"report  {report}")
