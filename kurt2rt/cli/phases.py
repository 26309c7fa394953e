"""`kurt2rt phases`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hal.robot_settings import load_robot
from kurt2rt.cli.command_options import takes_options
from kurt2rt.cli.json_output import AsJson
from kurt2rt.cli.options import (
    ALL_PROCESSORS,
    Changes,
    Jobs,
    changes_of,
    parse_seeds,
    results_option,
    seeds_option,
    task_option,
    teacher_option,
)
from kurt2rt.cli.progress import one_bar
from kurt2rt.cli.tables import print_study
from kurt2rt.core.teacher_settings import SUPERHUMAN

_SEEDS, _QUICK_SEEDS = "100-119", "0-1"
_FOLDER = Path("results/phases")


@dataclass(frozen=True, slots=True)
class _Options:
    """Options of `kurt2rt phases`."""

    task: Annotated[str, task_option("It needs a section `phases`. Default: wall_following.")] = "wall_following"
    teacher: Annotated[str, teacher_option(SUPERHUMAN)] = SUPERHUMAN
    changes: Changes = None
    quick: Annotated[
        bool, typer.Option("--quick", help="All steps with two robots in under a minute, each for seconds only.")
    ] = False
    seeds: Annotated[str | None, seeds_option(_SEEDS, _QUICK_SEEDS)] = None
    jobs: Jobs = ALL_PROCESSORS
    out: Annotated[Path | None, results_option(f"{_FOLDER}/ and the task's name, with -quick behind it")] = None
    as_json: AsJson = False


@takes_options(_Options)
def phases(options: _Options) -> None:
    """Train robots through all phases, 1 to 5, with a scripted teacher, and compare with controls.

    The path: untaught, answers (1), corrections (2), rewards (3), a critic is
    taught (4), the robot goes on alone (5); an exam after each, and a long run
    at the end. Branches from the set of phase 2 with wrong actions: untouched,
    answers only, unknown is -1, blame by chance, rewards, the critic alone, a
    shuffled critic; and the intact set with the critic.

    Leaves report.html, which holds everything, the figures as PNG, and each
    robot's results and knowledge files after each step in the output folder.

    A run that was interrupted goes on where it was. Results are kept with hashes
    of what made them; when that has changed, they are refused and not mixed in.
    Settings were searched on seeds 0 to 79; with one of those, or with fewer
    than 20 robots, nothing is judged.

    For example:

        kurt2rt phases --quick
        kurt2rt phases --task wall_following --seeds 100-119
    """
    # Not at the top: the simulator is an extra, and `kurt2rt run` on the robot does without it.
    from kurt2rt.core.task_settings import load_task, taught_by
    from kurt2rt.core.teacher_settings import load_teacher
    from kurt2rt.experiments.phases.figures import draw_figures
    from kurt2rt.experiments.phases.plan import make_plan
    from kurt2rt.experiments.phases.report import reasons_not_to_judge, write_report
    from kurt2rt.experiments.phases.summary import read_study
    from kurt2rt.experiments.phases.tables import all_tables
    from kurt2rt.experiments.study.jobs import JobParts
    from kurt2rt.experiments.study.plan import missing_time_s, run_missing
    from kurt2rt.experiments.study.results import Results
    from simbridge.simulation import Kurt2SimulationFactory

    typed_seeds = options.seeds or (_QUICK_SEEDS if options.quick else _SEEDS)
    profile = load_teacher(options.teacher)
    robot, settings = load_robot(), taught_by(load_task(options.task, changes=changes_of(options.changes)), profile)
    results = Results(options.out or _FOLDER / (settings.name + ("-quick" if options.quick else "")))
    plan = make_plan(
        settings,
        parse_seeds(typed_seeds),
        JobParts(factory=Kurt2SimulationFactory(robot), robot=robot, results=results),
        quick=options.quick,
    )
    with results.held(), one_bar(missing_time_s(plan, results)) as bar:
        run_missing(plan, results, options.jobs, bar.look)
        bar.say("figures and report")
        study = read_study(plan, results)
        pictures = list(draw_figures(study, results.folder))
        report = results.folder / "report.html"
        command = _command(options, typed_seeds)
        write_report(study, pictures, command, report)
    reasons = list(reasons_not_to_judge(plan))
    print_study(all_tables(study, reasons), reasons, report, as_json=options.as_json)


def _command(options: _Options, seeds: str) -> str:
    """Return the command as far as it decides the numbers, without paths of this machine."""
    words = ["kurt2rt phases", *(["--quick"] if options.quick else []), f"--task {Path(options.task).name}"]
    words += [f"--seeds {seeds}"]
    words += [f"--teacher {Path(options.teacher).name}"] if options.teacher != SUPERHUMAN else []
    return " ".join([*words, *(f"--set {each}" for each in options.changes or ())])
